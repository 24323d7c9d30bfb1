#pragma once

#include "common/runtime/result.h"

namespace conav::mapping_task {

/// Whether a page can be served at `port` of this machine; 0 always can. Errors: kUnavailable names
/// the port and the cause.
[[nodiscard]] Result<void> CheckPort(int port);

}  // namespace conav::mapping_task
