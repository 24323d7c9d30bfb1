#include "common/runtime/yaml_file.h"

#include <fmt/format.h>

#include "common/runtime/file.h"

namespace conav {

Result<YAML::Node> ReadYamlFile(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  try {
    return YAML::Load(*text);
  } catch (const YAML::Exception& error) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: not valid YAML: {}", file.string(), error.what()));
  }
}

}  // namespace conav
