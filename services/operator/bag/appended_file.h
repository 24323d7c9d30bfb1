#pragma once

#include <cstdint>
#include <filesystem>

#include "common/runtime/result.h"
#include "operator/bag/bytes.h"
#include "operator/bag/file_descriptor.h"

namespace conav::bag {

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

}  // namespace conav::bag
