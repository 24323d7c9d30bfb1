#include "operator/bag/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace conav::bag {
namespace {

tl::unexpected<Error> IoError(const std::filesystem::path& path, int cause) {
  return Fail(cause == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
              fmt::format("{}: {}", path.string(), std::strerror(cause)));
}

}  // namespace

Result<InputFile> InputFile::Open(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return IoError(path, errno);
  struct stat status {};
  const int code = fstat(descriptor, &status);
  InputFile file(path, descriptor, static_cast<std::uint64_t>(status.st_size));
  if (code != 0) return IoError(path, errno);
  if (!S_ISREG(status.st_mode)) return Fail(ErrorCode::kIo, path.string() + ": is no file");
  return file;
}

InputFile::InputFile(std::filesystem::path path, int descriptor, std::uint64_t size)
    : path_(std::move(path)), descriptor_(descriptor), size_(size) {}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<Bytes> InputFile::Read(std::uint64_t offset, std::uint64_t size) const {
  if (offset > size_ || size > size_ - offset) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: {} bytes from byte {} on are not in this file of {} bytes",
                            path_.string(), size, offset, size_));
  }
  Bytes bytes(size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = pread(descriptor_, bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return IoError(path_, errno);
    if (count == 0) return Fail(ErrorCode::kIo, path_.string() + ": became shorter");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

}  // namespace conav::bag
