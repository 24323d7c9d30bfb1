#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/in_memory_bus.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/clock.h"
#include "operator/config.h"
#include "operator/operator_service.h"
#include "support/drawn_map.h"
#include "support/temporary_folder.h"

namespace conav::operators {

using test::TemporaryFolder;

/// World w1, unless a test has another one.
inline const std::vector<std::string> kMap{"######", "#    #", "# ## #", "#    #", "######"};

inline OccupancyGrid DrawnTruth(const std::vector<std::string>& lines) {
  const BeliefGrid drawn = DrawnMap(lines);
  OccupancyGrid map(drawn.rows(), drawn.columns());
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float wall = drawn.values()[i];
    map.values()[i] = wall == 0.5F  ? Occupancy::kUnknown
                      : wall > 0.5F ? Occupancy::kOccupied
                                    : Occupancy::kFree;
  }
  return map;
}

/// Of r1 in (1,1): a wall at (1,3).
inline Snapshot SnapshotOf(std::uint64_t sequence_number) {
  return {.stamp = {10},
          .world = "w1",
          .robot = "r1",
          .sequence_number = sequence_number,
          .grid = {5, 6, 1.5},
          .cell = {1, 1},
          .position = {-2.25, 1.5},
          .horizontal_fov_rad = 1.4,
          .visible = {{{1, 1}, {1, 2}}, {{1, 3}}},
          .path = {{1, 1}},
          .goals_left = {{1, 4}}};
}

/// Says by hand what the simulator would say of world w1 and a robot, and listens to what comes
/// back.
struct HandMadeSim {
  /// `where`: an in-memory bus, or the options of a DDS participant.
  template <class Where>
  explicit HandMadeSim(const Where& where, const std::string& robot = "r1")
      : participant("sim", where),
        robot(robot),
        initial_map(participant, bus::kInitialMap, "w1"),
        goals(participant, bus::kRobotGoals, robot),
        snapshot(participant, bus::kSnapshot, robot),
        attention(participant, bus::kAttention, robot),
        belief(participant, bus::kBelief, "w1"),
        belief_map(participant, bus::kBeliefMap, "w1"),
        guidance(participant, bus::kGuidance, robot),
        queue(participant, bus::kAttentionQueue) {
    FindRobot();
  }

  void FindRobot() { state.emplace(participant, bus::kRobotState, robot); }
  void LoseRobot() { state.reset(); }

  void PublishInitialMap(const std::vector<std::string>& lines) {
    REQUIRE(initial_map.Publish(ToMessage(MapUpdate{{0}, 1.5, DrawnTruth(lines)})));
  }
  /// The map, and then that the robot stands on it.
  void Begin(const std::vector<std::string>& map = kMap) {
    PublishInitialMap(map);
    PublishState({1, 1}, 5);
  }
  void PublishState(Cell cell, std::int64_t stamp, std::uint64_t snapshots = 0,
                    const std::string& world = "w1") {
    const RobotState message{.stamp = {stamp},
                             .world = world,
                             .robot = robot,
                             .grid = grid,
                             .cell = cell,
                             .position = grid.CellToPosition(cell),
                             .goals_stamp = {++goals_published},
                             .goals_left = goals_left,
                             .goals_total = 1,
                             .path = {cell},
                             .snapshots = snapshots};
    REQUIRE(goals.Publish(ToMessage(GoalsOf(message, 0.5))));
    REQUIRE(state->Publish(ToMessage(message)));
  }

  void Ask(AttentionReason reason, double value_lost_per_s, std::uint64_t sequence_number = 1) {
    REQUIRE(attention.Publish(ToMessage(AttentionRequest{.world = "w1",
                                                         .robot = robot,
                                                         .sequence_number = sequence_number,
                                                         .reason = reason,
                                                         .cell = {1, 1},
                                                         .value_lost_per_s = value_lost_per_s})));
  }

  template <class T>
  static auto Newest(bus::Subscriber<T>& subscriber) {
    auto all = subscriber.TakeValid([](const T& message) { return ToDomain(message); });
    REQUIRE_FALSE(all.empty());
    return all.back();
  }
  Belief NewestBelief() { return Newest(belief); }
  Guidance NewestGuidance() { return Newest(guidance); }
  AttentionQueueState NewestQueue() { return Newest(queue); }

  bus::Participant participant;
  std::string robot;
  GridGeometry grid{5, 6, 1.5};          // of the states to come
  std::vector<Cell> goals_left{{1, 4}};  // of the states to come
  std::int64_t goals_published = 0;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map;
  bus::Publisher<conav_msgs::msg::RobotGoals> goals;
  std::optional<bus::Publisher<conav_msgs::msg::RobotState>> state;  // until the robot is lost
  bus::Publisher<conav_msgs::msg::Snapshot> snapshot;
  bus::Publisher<conav_msgs::msg::AttentionRequest> attention;
  bus::Subscriber<conav_msgs::msg::BeliefMap> belief;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> belief_map;
  bus::Subscriber<conav_msgs::msg::Guidance> guidance;
  bus::Subscriber<conav_msgs::msg::AttentionQueue> queue;
};

inline OperatorConfig ConfigFor(const std::filesystem::path& database) {
  OperatorConfig config;
  config.database = database.string();
  return config;
}

}  // namespace conav::operators
