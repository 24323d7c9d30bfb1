#include "common/runtime/file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace conav {
namespace {

/// Whole or not at all; a device or a pipe is written to, not replaced.
bool IsReplaced(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
}

tl::unexpected<Error> CannotWrite(const std::filesystem::path& path, const std::string& reason) {
  return Fail(ErrorCode::kIo, fmt::format("{}: cannot write: {}", path.string(), reason));
}

/// Writes to `target`; messages name `path`.
Result<void> WriteTo(const std::filesystem::path& target, const std::filesystem::path& path,
                     std::string_view bytes) {
  errno = 0;
  std::ofstream file(target, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return CannotWrite(path, std::strerror(errno));
  return {};
}

std::filesystem::path PartialPath(const std::filesystem::path& path) {
  std::filesystem::path partial = path;
  partial += ".partial";
  return partial;
}

}  // namespace

Result<std::string> ReadFile(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file", path.string()));
  }
  if (std::filesystem::is_directory(status)) {
    return Fail(ErrorCode::kIo, fmt::format("{}: is a folder", path.string()));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  return bytes;
}

Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes) {
  if (!IsReplaced(path)) return WriteTo(path, path, bytes);
  const std::filesystem::path partial = PartialPath(path);
  std::error_code error;
  if (const auto written = WriteTo(partial, path, bytes); !written) {
    std::filesystem::remove(partial, error);
    return written;
  }
  std::filesystem::rename(partial, path, error);
  if (!error) return {};
  const std::string reason = error.message();
  std::filesystem::remove(partial, error);
  return CannotWrite(path, reason);
}

Result<void> CheckWritable(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return CannotWrite(path, "is a folder");
  if (!IsReplaced(path)) return {};
  const std::filesystem::path partial = PartialPath(path);
  const auto written = WriteTo(partial, path, "");
  std::filesystem::remove(partial, error);
  return written;
}

}  // namespace conav
