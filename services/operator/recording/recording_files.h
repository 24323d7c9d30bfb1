#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/runtime/result.h"
#include "operator/recording/mcap_records.h"

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

/// A new file that grows by whole blocks: one that could not be written is cut off again, so that
/// the file ends with the block before it, and the next one may succeed.
/// Threads: one. Blocks on the disk; nothing is synced to it.
class AppendedFile {
 public:
  /// Errors: kIo with path and cause; a file that exists is not touched.
  [[nodiscard]] static Result<AppendedFile> Create(const std::filesystem::path& path);

  /// One write() where the system takes all of it at once. Errors: kIo with path and cause.
  [[nodiscard]] Result<void> Append(ByteSpan block);

  std::uint64_t size() const { return size_; }

 private:
  AppendedFile(std::filesystem::path path, FileDescriptor descriptor);

  std::filesystem::path path_;
  FileDescriptor descriptor_;
  std::uint64_t size_ = 0;
};

/// A file that is read in pieces.

/// Threads: one.
class InputFile {
 public:
  /// Errors: kNotFound, kIo, each with the path; a folder is kIo.
  [[nodiscard]] static Result<InputFile> Open(const std::filesystem::path& path);

  /// Errors: kIo with the path (also when the file has become shorter), kMalformed when the piece
  /// is not in the file.
  [[nodiscard]] Result<Bytes> Read(std::uint64_t offset, std::uint64_t size) const;

  /// When it was opened.
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  InputFile(std::filesystem::path path, FileDescriptor descriptor, std::uint64_t size);

  std::filesystem::path path_;
  FileDescriptor descriptor_;
  std::uint64_t size_;
};

}  // namespace conav::bag
