#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/result.h"

namespace conav {

/// What a reader of a file may hold in memory: of the file itself, and of what a small file unpacks
/// or decodes to.
inline constexpr std::uint64_t kReadLimit = std::uint64_t{512} << 20;

/// Reads all bytes of a file. Errors, with the path: kNotFound (no such file), kRefused (more than
/// kReadLimit), kIo with the cause (a folder, no permission for it or for a parent folder, a failing
/// device, ...).
[[nodiscard]] Result<std::string> ReadFile(const std::filesystem::path& path);

/// A file that comes with conav, below share/conav next to the folder of the running program.
std::filesystem::path ShippedFile(const std::filesystem::path& name);

/// Checks whether `path` is a file that ReadFile can open. Errors: as ReadFile.
[[nodiscard]] Result<void> CheckReadable(const std::filesystem::path& path);

/// Writes a temporary file next to `path` and renames it, so that a reader sees either the old file
/// or the new one. On failure the old file stays. If several writers race, the last wins. Writes a
/// device or pipe in place.
/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes);
/// The same, and on the disk once it returns, which survives a loss of power. Takes milliseconds.
[[nodiscard]] Result<void> WriteDurableFile(const std::filesystem::path& path,
                                            std::string_view bytes);
/// The same for secrets: nobody but the owner can read the file.
[[nodiscard]] Result<void> WriteSecretFile(const std::filesystem::path& path,
                                           std::string_view bytes);

/// Checks whether WriteFile(path) can work; call it before a long computation. Does not touch
/// `path`. Errors: kIo with path and cause.
[[nodiscard]] Result<void> CheckWritable(const std::filesystem::path& path);

/// An open file of the system, closed with this object; its number is below 0 if opening failed.
class FileDescriptor {
 public:
  /// `mode`: of a file that is made, less the umask.
  FileDescriptor(const std::filesystem::path& path, int flags, unsigned mode = 0666);
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() { Close(); }

  int number() const { return number_; }
  /// False with errno; a network file system may report a full disk only here.
  bool Close();

 private:
  int number_;
};

/// A file that grows by whole blocks: one that could not be written is cut off again, so that the
/// file ends with the block before it, and the next one may succeed. Each block survives a kill of
/// this process (not a loss of power).
/// Threads: one. Blocks on the disk; nothing is synced to it.
class AppendedFile {
 public:
  /// Makes the file. Errors: kIo with path and cause; a file that exists is not touched.
  [[nodiscard]] static Result<AppendedFile> Create(const std::filesystem::path& path);
  /// Opens or makes it. Errors: kIo with path and cause (also for a device); kUnavailable: another
  /// process appends to it.
  [[nodiscard]] static Result<AppendedFile> Continue(const std::filesystem::path& path);

  /// One write where the system takes all of it at once. Errors: kIo with path and cause.
  [[nodiscard]] Result<void> Append(std::string_view block);
  /// Appends what comes next behind its first `size` bytes. Errors: kIo with path and cause.
  [[nodiscard]] Result<void> CutTo(std::uint64_t size);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

 private:
  AppendedFile(std::filesystem::path path, int flags);

  std::filesystem::path path_;
  FileDescriptor descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace conav
