#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"
#include "planner/decision/search_config.h"

namespace conav::planner {

/// Section `planner:` of a config file.
struct PlannerConfig {
  bus::ParticipantOptions bus;
  /// "world/robot" of every robot that this planner drives.
  std::vector<std::string> robots{"w1/r1"};
  /// "ig-mcts", "instruction" or "teleop".
  std::string method = "ig-mcts";
  std::uint64_t seed = 1;
  SearchConfig search;
  /// "remote" asks the nhpm service and falls back to the embedded GLPF; "embedded" asks nobody.
  std::string perception = "remote";
  double perception_timeout_s = 2.0;
  /// How long a robot waits (wall time) for the operator's first path, and for the answer to a
  /// picture.
  double first_guidance_timeout_s = 10.0;
  double answer_timeout_s = 10.0;
  /// A command that was not finished after this long (simulation time) is void.
  double command_ttl_s = 10.0;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("robots", robots);
    reader.Choice("method", method, {"ig-mcts", "instruction", "teleop"});
    reader.Field("seed", seed);
    reader.Section("search", search);
    reader.Choice("perception", perception, {"remote", "embedded"});
    reader.Field("perception_timeout_s", perception_timeout_s, 0.01, 60.0);
    reader.Field("first_guidance_timeout_s", first_guidance_timeout_s, 0.0, 3600.0);
    reader.Field("answer_timeout_s", answer_timeout_s, 0.0, 3600.0);
    reader.Field("command_ttl_s", command_ttl_s, 0.5, 60.0);
  }
};

}  // namespace conav::planner
