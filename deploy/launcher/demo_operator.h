#pragma once

#include <string>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "operator/simulated_operator/config.h"

namespace conav::launcher {

/// The synthetic person that `--operator` means: a kind, or the `person` of a file's section
/// `simulated_operator:`. Throws StartupError: neither a kind nor a file, or what the file has wrong.
operators::SyntheticOperatorParameters OperatorPerson(const std::string& kind_or_file);

/// Whether OperatorPerson(options.simulated_operator) can be had. Errors: kInvalidArgument with the
/// option and the reason.
[[nodiscard]] Result<void> CheckOperator(const DemoOptions& options);

}  // namespace conav::launcher
