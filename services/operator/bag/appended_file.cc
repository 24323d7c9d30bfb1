#include "operator/bag/appended_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace conav::bag {

Result<AppendedFile> AppendedFile::Create(const std::filesystem::path& path) {
  FileDescriptor descriptor(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (descriptor.number() < 0) return IoError(path, errno);
  return AppendedFile(path, std::move(descriptor));
}

AppendedFile::AppendedFile(std::filesystem::path path, FileDescriptor descriptor)
    : path_(std::move(path)), descriptor_(std::move(descriptor)) {}

Result<void> AppendedFile::Append(ByteSpan block) {
  std::size_t written = 0;
  while (written < block.size()) {
    const ssize_t count = pwrite(descriptor_.number(), block.data() + written,
                                 block.size() - written, static_cast<off_t>(size_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int cause = count < 0 ? errno : ENOSPC;
      // If this fails, too, the next block overwrites what is there.
      [[maybe_unused]] const int ignored =
          ftruncate(descriptor_.number(), static_cast<off_t>(size_));
      return IoError(path_, cause);
    }
    written += static_cast<std::size_t>(count);
  }
  size_ += block.size();
  return {};
}

}  // namespace conav::bag
