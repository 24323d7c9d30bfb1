#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"
#include "operator/simulated/synthetic_operator.h"

namespace conav::operators {

/// Section `simulated_operator:` of a config file.
struct SimulatedOperatorConfig {
  bus::ParticipantOptions bus;
  /// "world/robot" of every robot that this synthetic person looks after.
  std::vector<std::string> robots{"w1/r1"};
  /// "guidance" answers pictures by edits and paths; "teleoperation" steers by keys.
  std::string interaction = "guidance";
  std::uint64_t seed = 1;
  /// Name under which it edits and guides; a number is added that makes it unique.
  std::string client = "synthetic-operator";
  /// After this long (wall time) without a reply a request counts as failed.
  double request_deadline_s = 10.0;
  SyntheticOperatorParameters person;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("robots", robots);
    reader.Choice("interaction", interaction, {"guidance", "teleoperation"});
    reader.Field("seed", seed);
    reader.Field("client", client);
    reader.Field("request_deadline_s", request_deadline_s, 0.1, 3600.0);
    reader.Section("person", person);
  }
};

}  // namespace conav::operators
