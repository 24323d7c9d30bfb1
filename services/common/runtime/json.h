#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "common/runtime/result.h"

namespace conav {

/// Writes `document` (indented, final newline) to a temporary file beside `path` and renames it, so
/// that a reader sees the old file or the new one, never half of it. Errors: kIo with path and
/// cause.
[[nodiscard]] Result<void> WriteJsonFile(const std::filesystem::path& path,
                                         const nlohmann::ordered_json& document);

}  // namespace conav
