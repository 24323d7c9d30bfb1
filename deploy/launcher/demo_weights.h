#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"

namespace conav::launcher {

/// Whether the weights that `options` name can be read and answer for maps of the run's size, so
/// that a run does not go on with the fallback unasked. Those that come with conav are not looked
/// at. Errors: the option, the file and the reason.
[[nodiscard]] Result<void> CheckWeights(const DemoOptions& options);

/// The SHA-256 of the weights that shall answer, as services report it: those of --person, of
/// --weights, or those that come with conav. Empty where there are none, or they cannot be read.
std::string WeightsChecksum(const DemoOptions& options);

}  // namespace conav::launcher
