#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav {

/// A file that grows by whole zstd frames while a session runs: each is handed to the operating system
/// before Append() returns, so that it outlives a kill of this process (not a loss of power).
///
/// Threads: not synchronised; one owner. Calls block on the disk.
class FrameLog {
 public:
  /// Looks at what the file has so far, complete frames only; not called for a new file.
  using Check = std::function<Result<void>(std::string_view frames)>;

  /// Makes the file, or goes on after the frames that it has. A last frame that a kill cut off is
  /// moved to the end of `<path>.torn`, which is logged. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process records
  /// to it); kMalformed (no zstd, damaged, none of its frames is complete); those of `check`.
  [[nodiscard]] static Result<FrameLog> Open(const std::filesystem::path& path, const Check& check);

  FrameLog(FrameLog&& other) noexcept;
  FrameLog& operator=(FrameLog&&) = delete;
  ~FrameLog();

  const std::filesystem::path& path() const { return path_; }
  bool empty() const { return size_ == 0; }

  /// Errors: kIo with path and cause; then the file is as it was.
  [[nodiscard]] Result<void> Append(std::string_view frame);

 private:
  FrameLog(std::filesystem::path path, int file);
  Result<void> Begin(const Check& check);
  Result<void> SetAside(std::string_view torn_end);
  Error Failure(const std::string& what) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace conav
