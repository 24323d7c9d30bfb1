#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/msg/method.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/runtime/config.h"
#include "planner/decision/method.h"
#include "planner/methods/method_config.h"

namespace conav::planner {

inline bool IsNodeName(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return IsEntityName(name);
}

/// How planner processes share the robots that several of them list (decision/leases.h). Wall time.
struct LeaseConfig {
  double period_s = 0.25;  // between announcements
  /// A process that sends nothing for longer counts as gone, and the others take over its robots.
  double timeout_s = 2.0;
  /// Processes to wait for at the start, at most timeout_s, so that robots need not change hands at
  /// once; more or fewer may come.
  int planners = 1;

  void Visit(ConfigReader& reader) {
    reader.Field("period_s", period_s, 0.02, 60.0);
    reader.Field("timeout_s", timeout_s, 0.1, 600.0);
    if (timeout_s < 2.0 * period_s) reader.Refuse("timeout_s", "is below two periods");
    reader.Field("planners", planners, 1, 64);
  }
};

/// Section `planner:` of a config file.
struct PlannerConfig {
  bus::ParticipantOptions bus;
  /// Node name; give each process its own.
  std::string name = "planner";
  /// "world/robot" of every robot that this planner may drive; it shares a robot with the other
  /// processes that list it, by `lease`.
  std::vector<std::string> robots{"w1/r1"};
  LeaseConfig lease;
  MethodKind method = MethodKind::kIgMcts;
  std::uint64_t seed = 1;
  SearchConfig search;
  /// The policy that decides when ig-mcts sends a picture.
  CommunicationConfig communication;
  /// "remote" asks the nhpm service; "embedded" asks the model in this process. While neither can
  /// answer, the embedded GLPF does.
  std::string perception = "remote";
  /// Answers of a service with another model are rejected.
  PerceptionModelKind perception_model = PerceptionModelKind::kNhpm;
  /// SHA-256 of the only weights whose answers are accepted (remote); empty = any.
  std::string perception_checksum;
  /// Weights file of an embedded network; empty = the one that comes with conav.
  std::string weights;
  /// Whose edits are predicted, when the service has a model of that operator (remote); empty = the
  /// average operator's.
  std::string person;
  double perception_timeout_s = 2.0;
  /// Memory for remembered answers, MiB for each world; the oldest are forgotten.
  double perception_cache_mib = 128.0;
  /// The operator's map: "observed" = as the operator service publishes it; "estimated" = as first
  /// published, changed by the edits that the perception model expects after each picture
  /// (docs/paper.md A13); "none" = the same, beginning with a map of which nothing is known (0.5).
  std::string x_source = "observed";
  /// What the robots know of their goals: all of them, those that they have seen or that the
  /// operator's path leads over, or those of their state while it counts more.
  GoalKnowledge goal_knowledge = GoalKnowledge::kAll;
  /// How long a robot waits (wall time) for the operator's first path, and for the answer to a
  /// picture.
  double first_guidance_timeout_s = 10.0;
  double answer_timeout_s = 10.0;
  /// "wall", or "simulation" for these two timeouts where simulation time passes by itself
  /// (sim.speed above 0), as in a study of waiting.
  std::string timeout_clock = "wall";
  /// A command that is not finished after this long (simulation time) expires.
  double command_ttl_s = 10.0;
  /// File to append every decision to, for `conav explain`; empty = none. Created when it does not
  /// exist; its folder must exist. Goes together with `search: {report: tree}`.
  std::string decision_file;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("name", name);
    if (!IsNodeName(name)) reader.Refuse("name", "is not 1 to 64 of A-Z a-z 0-9 _ -");
    reader.Field("robots", robots);
    reader.Section("lease", lease);
    reader.Choice("method", method, kMethods);
    reader.Field("seed", seed);
    reader.Section("search", search);
    reader.Section("communication", communication);
    reader.Choice("perception", perception, {"remote", "embedded"});
    reader.Choice("perception_model", perception_model, kPlannersModels);
    reader.Field("perception_checksum", perception_checksum);
    const bool digits =
        perception_checksum.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!perception_checksum.empty() && (!digits || perception_checksum.size() != 64)) {
      reader.Refuse("perception_checksum", "is not 64 lower-case hexadecimal digits");
    }
    reader.Field("weights", weights);
    reader.Field("person", person);
    if (!person.empty() && !IsEntityName(person)) {
      reader.Refuse("person", "is not 1 to 64 of A-Z a-z 0-9 _");
    }
    reader.Choice("x_source", x_source, {"observed", "estimated", "none"});
    reader.Choice("goal_knowledge", goal_knowledge, kGoalKnowledges);
    reader.Field("perception_timeout_s", perception_timeout_s, 0.01, 60.0);
    reader.Field("perception_cache_mib", perception_cache_mib, 0.0, 1e5);
    reader.Field("first_guidance_timeout_s", first_guidance_timeout_s, 0.0, 3600.0);
    reader.Field("answer_timeout_s", answer_timeout_s, 0.0, 3600.0);
    reader.Choice("timeout_clock", timeout_clock, {"wall", "simulation"});
    reader.Field("command_ttl_s", command_ttl_s, 0.5, 60.0);
    reader.Field("decision_file", decision_file);
  }
};

}  // namespace conav::planner
