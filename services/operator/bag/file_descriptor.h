#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <utility>

#include "common/runtime/result.h"

namespace conav::bag {

/// An open file of the system, closed with this object.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() {
    if (number_ >= 0) close(number_);
  }

  int number() const { return number_; }

 private:
  int number_;
};

/// `cause`: an errno.
inline tl::unexpected<Error> IoError(const std::filesystem::path& path, int cause,
                                     ErrorCode code = ErrorCode::kIo) {
  return Fail(code, fmt::format("{}: {}", path.string(), std::strerror(cause)));
}

}  // namespace conav::bag
