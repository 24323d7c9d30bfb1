#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav {

/// Reads all bytes of a file. Errors, with the path: kNotFound (no such file), kIo with the cause
/// (a folder, no permission for it or for a parent folder, a failing device, ...).
[[nodiscard]] Result<std::string> ReadFile(const std::filesystem::path& path);

/// Writes a temporary file next to `path` and renames it, so that a reader sees either the old file
/// or the new one. On failure the old file stays. If several writers race, the last wins. Writes a
/// device or pipe in place.
/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes);

/// Checks whether WriteFile(path) can work; call it before a long computation. Does not touch
/// `path`. Errors: kIo with path and cause.
[[nodiscard]] Result<void> CheckWritable(const std::filesystem::path& path);

}  // namespace conav
