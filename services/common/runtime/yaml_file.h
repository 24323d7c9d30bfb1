#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "common/runtime/result.h"

namespace conav {

/// The document of a YAML file, whatever it is made of; that of an empty file is null.
/// Errors, each naming the file: those of ReadFile, kMalformed.
[[nodiscard]] Result<YAML::Node> ReadYamlFile(const std::filesystem::path& file);

}  // namespace conav
