#pragma once

#include <cstdint>
#include <filesystem>

#include "common/runtime/result.h"
#include "operator/bag/bytes.h"
#include "operator/bag/file_descriptor.h"

namespace conav::bag {

/// A file that is read in pieces. Threads: one.
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
