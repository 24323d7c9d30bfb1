#include "operator/bag/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace conav::bag {

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
