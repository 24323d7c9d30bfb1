#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "common/protocol/planning.h"
#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "operator/alerts/alert.h"
#include "operator/console/console_state.h"

/// What a console hears of a run, one value for each message or conclusion.
namespace conav::operators {

struct SeenMap {
  std::string robot;
  std::string world;
  MapUpdate map;
};
/// The map that the operator began with: it tells how large the world is.
struct InitialMap {
  std::string world;
  MapUpdate map;
};
struct TrueMap {
  std::string world;
  MapUpdate map;
};
struct HeardBelief {
  Belief belief;
  std::shared_ptr<const BeliefGrid> initial;
};
struct PlannedWay {
  std::string robot;
  SimTime stamp;
  std::vector<Cell> cells;
};
struct GoalSet {
  std::string robot;
  Cell cell;
  SimTime stamp;
};
/// "Nothing new here"; before the guidance that the operator service made of it.
struct PictureAnswered {
  std::string robot;
  std::uint64_t snapshot = 0;
  std::string client;
};
struct StreamFrame {
  std::string robot;
  SimTime stamp;
  std::vector<std::uint8_t> jpeg;
};
/// Times of an alert: positions in the recording, s.
using Heard = std::variant<RobotState, SeenMap, InitialMap, TrueMap, HeardBelief, Guidance,
                           PlannedWay, GoalSet, SearchReport, Picture, PictureAnswered, StreamFrame,
                           AttentionQueueState, HoldOrder, ServiceHealth, Alert, console::Event>;

}  // namespace conav::operators
