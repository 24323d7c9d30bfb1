#include "common/runtime/json.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

namespace conav {

Result<void> WriteJsonFile(const std::filesystem::path& path,
                           const nlohmann::ordered_json& document) {
  // Whole or not at all; a device or a pipe is written to, not replaced.
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool replaces =
      !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
  std::filesystem::path target = path;
  if (replaces) target += ".partial";
  errno = 0;
  std::ofstream file(target);
  file << document.dump(2) << '\n';
  file.close();
  if (!file) {
    const std::string reason = std::strerror(errno);
    if (replaces) std::filesystem::remove(target, error);
    return Fail(ErrorCode::kIo, fmt::format("{}: cannot write: {}", path.string(), reason));
  }
  error.clear();
  if (replaces) std::filesystem::rename(target, path, error);
  if (error) return Fail(ErrorCode::kIo, fmt::format("{}: {}", path.string(), error.message()));
  return {};
}

}  // namespace conav
