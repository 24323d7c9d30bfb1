#pragma once

#include <string>
#include <vector>

#include "common/service/diagnostics.h"

namespace conav {

/// What a process says of itself on /diagnostics.
struct ReportedHealth {
  std::string process;
  Health::Level level = Health::Level::kOk;
  std::string message;
};

/// Of conav's processes; others that publish there are left out. Names and messages are made
/// Readable(); a level that REP-107 counts as worse than an error (stale) is an error.
std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message);

}  // namespace conav
