#include "common/runtime/json.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

namespace conav {

Result<void> WriteJsonFile(const std::filesystem::path& path,
                           const nlohmann::ordered_json& document) {
  std::filesystem::path temporary = path;
  temporary += ".partial";
  std::ofstream file(temporary);
  file << document.dump(2) << '\n';
  file.close();
  if (!file) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: cannot write: {}", path.string(), std::strerror(errno)));
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) return Fail(ErrorCode::kIo, fmt::format("{}: {}", path.string(), error.message()));
  return {};
}

}  // namespace conav
