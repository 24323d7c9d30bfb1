#include "common/runtime/file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <random>

namespace conav {
namespace {

/// True for files that are replaced whole; false for a device or pipe, which is written in place.
bool IsReplaced(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
}

/// By errno.
tl::unexpected<Error> CannotRead(const std::filesystem::path& path) {
  if (errno == ENOENT || errno == ENOTDIR) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file", path.string()));
  }
  return Fail(ErrorCode::kIo,
              fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
}

tl::unexpected<Error> CannotWrite(const std::filesystem::path& path, const std::string& reason) {
  return Fail(ErrorCode::kIo, fmt::format("{}: cannot write: {}", path.string(), reason));
}

constexpr unsigned kForAll = 0666;
constexpr unsigned kForOwner = 0600;

/// Creates `target` with `flags` and `mode` and writes it; messages name `path`.
/// Whether it survives a loss of power.
enum class Sync { kNo, kYes };

Result<void> WriteTo(const std::filesystem::path& target, int flags, unsigned mode,
                     const std::filesystem::path& path, std::string_view bytes, Sync sync) {
  FileDescriptor file(target, O_WRONLY | flags, mode);
  if (file.number() < 0 && errno == ENOENT) {
    return CannotWrite(path, fmt::format("there is no folder {}", path.parent_path().string()));
  }
  if (file.number() < 0) return CannotWrite(path, std::strerror(errno));
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return CannotWrite(path, std::strerror(errno));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (sync == Sync::kYes && ::fsync(file.number()) != 0) {
    return CannotWrite(path, std::strerror(errno));
  }
  if (!file.Close()) return CannotWrite(path, std::strerror(errno));
  return {};
}

/// A name that no other writer of `path` uses.
std::filesystem::path PartialPath(const std::filesystem::path& path) {
  std::random_device entropy;
  std::filesystem::path partial = path;
  partial += fmt::format(".{:08x}{:08x}.partial", entropy(), entropy());
  return partial;
}

/// Writes a new file and removes it again on failure; messages name `path`.
Result<void> WritePartial(const std::filesystem::path& partial, unsigned mode,
                          const std::filesystem::path& path, std::string_view bytes, Sync sync) {
  return WriteTo(partial, O_CREAT | O_EXCL, mode, path, bytes, sync).map_error([&](Error error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    return error;
  });
}

/// The names in it. A file system that cannot do so keeps them in its own way.
void SyncFolder(const std::filesystem::path& folder) {
  const FileDescriptor names(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (names.number() >= 0) static_cast<void>(::fsync(names.number()));
}

Result<void> Replace(const std::filesystem::path& path, unsigned mode, std::string_view bytes,
                     Sync sync = Sync::kNo) {
  if (!IsReplaced(path)) return WriteTo(path, 0, mode, path, bytes, Sync::kNo);
  const std::filesystem::path partial = PartialPath(path);
  if (const auto written = WritePartial(partial, mode, path, bytes, sync); !written) return written;
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (!error) {
    if (sync == Sync::kYes) SyncFolder(path.parent_path());
    return {};
  }
  const std::string reason = error.message();
  std::filesystem::remove(partial, error);
  return CannotWrite(path, reason);
}

}  // namespace

Result<std::string> ReadFile(const std::filesystem::path& path) {
  const FileDescriptor file(path, O_RDONLY);
  if (file.number() < 0) return CannotRead(path);
  const auto too_large = [&] {
    return Fail(ErrorCode::kRefused,
                fmt::format("{}: has more than {} MiB, the limit of a file that is read whole",
                            path.string(), kReadLimit >> 20));
  };
  std::string bytes;
  struct stat status {};
  if (::fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode)) {
    if (static_cast<std::uint64_t>(status.st_size) > kReadLimit) return too_large();
    bytes.reserve(static_cast<std::size_t>(status.st_size));
  }
  std::array<char, 1U << 16> piece;
  while (true) {
    const ssize_t size = ::read(file.number(), piece.data(), piece.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return CannotRead(path);
    if (size == 0) return bytes;
    if (bytes.size() + static_cast<std::size_t>(size) > kReadLimit) return too_large();
    bytes.append(piece.data(), static_cast<std::size_t>(size));
  }
}

std::filesystem::path ShippedFile(const std::filesystem::path& name) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return program.parent_path().parent_path() / "share/conav" / name;
}

Result<void> CheckReadable(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (!is_folder && ::access(path.c_str(), R_OK) == 0) return {};
  if (is_folder) errno = EISDIR;
  return CannotRead(path);
}

Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes) {
  return Replace(path, kForAll, bytes);
}

Result<void> WriteDurableFile(const std::filesystem::path& path, std::string_view bytes) {
  return Replace(path, kForAll, bytes, Sync::kYes);
}

Result<void> WriteSecretFile(const std::filesystem::path& path, std::string_view bytes) {
  return Replace(path, kForOwner, bytes);
}

Result<void> CheckWritable(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return CannotWrite(path, "is a folder");
  if (!IsReplaced(path)) return {};
  const std::filesystem::path partial = PartialPath(path);
  const auto written = WritePartial(partial, kForAll, path, "", Sync::kNo);
  std::filesystem::remove(partial, error);
  return written;
}

FileDescriptor::FileDescriptor(const std::filesystem::path& path, int flags, unsigned mode)
    : number_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}

bool FileDescriptor::Close() { return number_ < 0 || ::close(std::exchange(number_, -1)) == 0; }

AppendedFile::AppendedFile(std::filesystem::path path, int flags)
    : path_(std::move(path)), descriptor_(path_, flags) {}

Result<AppendedFile> AppendedFile::Create(const std::filesystem::path& path) {
  AppendedFile file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (file.descriptor_.number() < 0) return CannotWrite(path, std::strerror(errno));
  return file;
}

Result<AppendedFile> AppendedFile::Continue(const std::filesystem::path& path) {
  AppendedFile file(path, O_RDWR | O_CREAT);
  const int number = file.descriptor_.number();
  // Reading a device might never end.
  if (number < 0 || !std::filesystem::is_regular_file(path)) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: cannot record: {}", path.string(),
                            number < 0 ? std::strerror(errno) : "it is not a regular file"));
  }
  if (::flock(number, LOCK_EX | LOCK_NB) != 0) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: another process records to it", path.string()));
  }
  file.size_ = std::filesystem::file_size(path);
  return file;
}

Result<void> AppendedFile::Append(std::string_view block) {
  std::size_t done = 0;
  while (done < block.size()) {
    const ssize_t count = ::pwrite(descriptor_.number(), block.data() + done, block.size() - done,
                                   static_cast<off_t>(size_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int cause = count < 0 ? errno : ENOSPC;
      // If this fails, too, the next block overwrites what is there.
      [[maybe_unused]] const int ignored =
          ::ftruncate(descriptor_.number(), static_cast<off_t>(size_));
      return CannotWrite(path_, std::strerror(cause));
    }
    done += static_cast<std::size_t>(count);
  }
  size_ += block.size();
  return {};
}

Result<void> AppendedFile::CutTo(std::uint64_t size) {
  if (::ftruncate(descriptor_.number(), static_cast<off_t>(size)) != 0) {
    return CannotWrite(path_, std::strerror(errno));
  }
  size_ = size;
  return {};
}

}  // namespace conav
