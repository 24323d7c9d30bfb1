#pragma once

#include "launcher/demo_options.h"

namespace conav::launcher {

/// Reads `conav demo ...`. Exits by itself: 0 for --help, 2 for wrong use with the reason on
/// stderr.
DemoOptions ParseDemoCommand(int argc, char** argv);

}  // namespace conav::launcher
