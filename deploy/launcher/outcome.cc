#include "launcher/outcome.h"

#include <fmt/format.h>

#include <cstdlib>

namespace conav::launcher {
namespace {

const char* Name(EndReason reason) {
  switch (reason) {
    case EndReason::kAllGoalsReached:
      return "all goals reached";
    case EndReason::kProcessDied:
      return "process died";
    case EndReason::kTimeLimit:
      return "time limit";
    case EndReason::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::string WeightsText(const DemoOptions& options) {
  if (options.model != kNhpmModel) return "";
  return options.weights.empty() ? "shipped" : options.weights.string();
}

nlohmann::ordered_json Versions() {
  nlohmann::ordered_json versions{{"conav", CONAV_VERSION}};
  // ./conav knows the commit that it built; a program run by hand does not.
  if (const char* commit = std::getenv("CONAV_COMMIT")) versions["commit"] = commit;
  return versions;
}

}  // namespace

nlohmann::ordered_json OutcomeJson(const DemoOptions& options, const Outcome& outcome,
                                   const EpisodeMetrics& metrics) {
  nlohmann::ordered_json json{{"seed", options.seed},
                              {"maze_seed", options.world_seed()},
                              {"rotation_deg", options.rotation_deg},
                              {"method", options.method},
                              {"communication", options.communication},
                              {"model", options.model},
                              {"weights", WeightsText(options)},
                              {"weights_checksum", outcome.weights_checksum},
                              {"person", options.person},
                              {"person_weights", options.person_weights.string()},
                              {"nhpm_replicas", options.nhpm_processes()},
                              {"planners", options.planners},
                              {"x_source", options.x_source},
                              {"dds", outcome.dds},
                              {"worlds", options.worlds},
                              {"robots_per_world", options.robots},
                              {"operator", "simulated"},
                              {"simulated_operator", options.simulated_operator},
                              {"preset", options.map.empty() ? options.preset : ""},
                              {"map", options.map.string()},
                              {"perception", options.perception},
                              {"camera", options.camera},
                              {"speed", options.effective_speed()},
                              {"domain", outcome.domain},
                              {"ended", Name(outcome.reason)},
                              {"detail", outcome.detail},
                              {"wall_s", outcome.wall_s},
                              {"run", outcome.run_folder},
                              {"versions", Versions()}};
  json.update(ToJson(metrics));
  return json;
}

std::string OutcomeLine(const Outcome& outcome) {
  const std::string what = outcome.reason == EndReason::kProcessDied && !outcome.detail.empty()
                               ? outcome.detail
                               : Name(outcome.reason);
  return fmt::format("ended after {:.1f} s: {}", outcome.wall_s, what);
}

}  // namespace conav::launcher
