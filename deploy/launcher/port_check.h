#pragma once

#include <string>

#include "common/runtime/result.h"

namespace conav::launcher {

/// Whether a page can be served at `port` of this machine, which `option` names; 0 always can.
/// Errors: kUnavailable names option, port and cause.
[[nodiscard]] Result<void> CheckPort(const std::string& option, int port);

}  // namespace conav::launcher
