#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/runtime/result.h"

namespace conav {

/// Indented, with a final newline. Bytes that are no UTF-8, as a file's name may have, become U+FFFD.
std::string JsonText(const nlohmann::ordered_json& document);

/// Writes JsonText to a temporary file beside `path` and renames it, so
/// that a reader sees the old file or the new one, never half of it. Errors: kIo with path and
/// cause.
[[nodiscard]] Result<void> WriteJsonFile(const std::filesystem::path& path,
                                         const nlohmann::ordered_json& document);

}  // namespace conav
