#pragma once

#include <filesystem>

#include "common/runtime/result.h"

namespace conav::bag {

/// The recording of `run`, a run's folder or the file itself, which need not exist.
/// Errors: kNotFound: a folder without one.
[[nodiscard]] Result<std::filesystem::path> RecordingOf(const std::filesystem::path& run);

}  // namespace conav::bag
