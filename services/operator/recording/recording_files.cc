#include "operator/recording/recording_files.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>

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

Result<InputFile> InputFile::Open(const std::filesystem::path& path) {
  FileDescriptor descriptor(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.number() < 0) {
    return IoError(path, errno, errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo);
  }
  struct stat status {};
  if (fstat(descriptor.number(), &status) != 0) return IoError(path, errno);
  if (!S_ISREG(status.st_mode)) return Fail(ErrorCode::kIo, path.string() + ": is no file");
  return InputFile(path, std::move(descriptor), static_cast<std::uint64_t>(status.st_size));
}

InputFile::InputFile(std::filesystem::path path, FileDescriptor descriptor, std::uint64_t size)
    : path_(std::move(path)), descriptor_(std::move(descriptor)), size_(size) {}

Result<Bytes> InputFile::Read(std::uint64_t offset, std::uint64_t size) const {
  if (offset > size_ || size > size_ - offset) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: {} bytes from byte {} on are not in this file of {} bytes",
                            path_.string(), size, offset, size_));
  }
  Bytes bytes(size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = pread(descriptor_.number(), bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return IoError(path_, errno);
    if (count == 0) return Fail(ErrorCode::kIo, path_.string() + ": became shorter");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

}  // namespace conav::bag
