#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav {

/// All bytes of a file. Errors, with the path: kNotFound (nothing has this name), kIo with the cause
/// (a folder, no permission for it or for a folder above it, a device that fails, ...).
[[nodiscard]] Result<std::string> ReadFile(const std::filesystem::path& path);

/// Writes beside `path` and renames, so that a reader sees the old file or the new one, never half
/// of it; the old file stays when writing fails. Of several who write one path at a time the last
/// wins. A device or a pipe is written to, not replaced.
/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes);

/// Finds out whether WriteFile(path) can work, for those who will have something to write only
/// after a long computation. Leaves `path` alone. Errors: kIo with path and cause.
[[nodiscard]] Result<void> CheckWritable(const std::filesystem::path& path);

}  // namespace conav
