#include "common/runtime/json.h"

#include <nlohmann/json.hpp>

#include "common/runtime/file.h"

namespace conav {

Result<void> WriteJsonFile(const std::filesystem::path& path,
                           const nlohmann::ordered_json& document) {
  return WriteFile(path, document.dump(2) + "\n");
}

}  // namespace conav
