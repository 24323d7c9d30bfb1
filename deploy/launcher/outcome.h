#pragma once

#include <string>
#include <vector>

#include "launcher/demo_options.h"
#include "launcher/metrics.h"

namespace conav::launcher {

/// Why a demo ended.
enum class EndReason { kAllGoalsReached, kProcessDied, kTimeLimit, kInterrupted };

struct Outcome {
  EndReason reason = EndReason::kAllGoalsReached;
  std::string detail;  // which process died and how; empty when all went well
  double wall_s = 0.0;
  std::string dds;  // as asked for, or the default vendor
  int domain = 0;
  std::string run_folder;
  std::string weights_checksum;  // of the weights that shall answer; empty without
};

/// What metrics.json and --json hold: the run's facts, then the measures of ToJson(metrics).
nlohmann::ordered_json OutcomeJson(const DemoOptions& options, const Outcome& outcome,
                                   const EpisodeMetrics& metrics);

/// "ended: all goals reached", "ended: planner (pid 12) died: signal 9 (Killed)".
std::string OutcomeLine(const Outcome& outcome);

}  // namespace conav::launcher
