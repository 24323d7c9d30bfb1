#include "operator/bag/appended_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace conav::bag {
namespace {

tl::unexpected<Error> IoError(const std::filesystem::path& path, int cause) {
  return Fail(ErrorCode::kIo, fmt::format("{}: {}", path.string(), std::strerror(cause)));
}

}  // namespace

Result<AppendedFile> AppendedFile::Create(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return IoError(path, errno);
  return AppendedFile(path, descriptor);
}

AppendedFile::AppendedFile(std::filesystem::path path, int descriptor)
    : path_(std::move(path)), descriptor_(descriptor) {}

AppendedFile::AppendedFile(AppendedFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

AppendedFile::~AppendedFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<void> AppendedFile::Append(ByteSpan block) {
  std::size_t written = 0;
  while (written < block.size()) {
    const ssize_t count = pwrite(descriptor_, block.data() + written, block.size() - written,
                                 static_cast<off_t>(size_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int cause = count < 0 ? errno : ENOSPC;
      // If this fails, too, the next block overwrites what is there.
      [[maybe_unused]] const int ignored = ftruncate(descriptor_, static_cast<off_t>(size_));
      return IoError(path_, cause);
    }
    written += static_cast<std::size_t>(count);
  }
  size_ += block.size();
  return {};
}

}  // namespace conav::bag
