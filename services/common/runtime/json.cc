#include "common/runtime/json.h"

#include <nlohmann/json.hpp>

#include "common/runtime/file.h"

namespace conav {

std::string JsonText(const nlohmann::ordered_json& document) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  return document.dump(2, ' ', false, kReplace) + "\n";
}

Result<void> WriteJsonFile(const std::filesystem::path& path,
                           const nlohmann::ordered_json& document) {
  return WriteFile(path, JsonText(document));
}

}  // namespace conav
