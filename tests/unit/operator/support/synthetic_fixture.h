#pragma once

#include <catch2/catch.hpp>
#include <map>
#include <string>

#include "operator/simulated/synthetic_operator.h"
#include "unit/operator/support/drawn_map.h"

/// What the tests of the synthetic operator share: a small map, messages of its world, and a desk
/// at which a person sits.
namespace conav::operators {

inline const BeliefGrid kMap = DrawnMap({"######", "#    #", "# ## #", "#    #", "######"});

inline SyntheticOperatorParameters Flawless() {
  SyntheticOperatorParameters parameters;
  parameters.reader.edit_probability = 1.0;
  parameters.reader.decay_cells = 1e6;
  parameters.reader.path_removal_probability = 1.0;
  parameters.reader.lateral_factor = 1.0;
  parameters.reader.misplacement_probability = 0.0;
  parameters.reader.lapse_probability = 0.0;
  parameters.reader.guess_probability = 0.0;
  parameters.glance_rate = 1.0;
  return parameters;
}

inline Belief MapAt(std::uint64_t revision, BeliefGrid map = kMap) {
  return {{0}, "w1", revision, std::move(map), ""};
}

inline RobotState StateAt(Cell cell, std::int64_t stamp, const std::string& robot = "r1") {
  RobotState state;
  state.stamp = {stamp};
  state.world = "w1";
  state.robot = robot;
  state.cell = cell;
  state.goals_left = {{1, 4}};
  return state;
}

/// From (1,1): a wall at (1,3), which the map does not have.
inline Snapshot SnapshotOf(std::uint64_t sequence_number, std::int64_t stamp,
                           bool streamed = false) {
  Snapshot picture;
  picture.stamp = {stamp};
  picture.world = "w1";
  picture.robot = "r1";
  picture.sequence_number = sequence_number;
  picture.streamed = streamed;
  picture.cell = {1, 1};
  picture.visible = {{{1, 1}, {1, 2}}, {{1, 3}}};
  picture.path = {{1, 1}};
  picture.goals_left = {{1, 4}};
  return picture;
}

inline AttentionRequest Attention(AttentionReason reason, Cell cell, std::uint64_t newest_snapshot,
                                  std::int64_t stamp, std::uint64_t sequence_number = 1) {
  return {{stamp}, "w1", "r1", sequence_number, reason, cell, newest_snapshot, 0.0, 0.0};
}

/// A person with robots r1 and r2 of world w1, and a clock in the test's hand.
struct Desk {
  explicit Desk(const SyntheticOperatorParameters& parameters = Flawless(),
                const std::map<std::string, std::string>& robots = {{"r1", "w1"}})
      : person(parameters, 1, robots) {}

  EditRequest ExpectEdit() {
    const auto ask = person.Next(clock.Now());
    REQUIRE(ask.has_value());
    REQUIRE(std::holds_alternative<EditRequest>(ask->body));
    return std::get<EditRequest>(ask->body);
  }
  GuideRequest ExpectGuide() {
    const auto ask = person.Next(clock.Now());
    REQUIRE(ask.has_value());
    CHECK(ask->world == "w1");
    REQUIRE(std::holds_alternative<GuideRequest>(ask->body));
    return std::get<GuideRequest>(ask->body);
  }
  void ExpectNothing() { CHECK_FALSE(person.Next(clock.Now()).has_value()); }
  void Accept(std::uint64_t revision) {
    person.Answered(OperatorReply{"c", 1, true, "", revision}, clock.Now());
  }
  void Refuse(std::uint64_t revision) {
    person.Answered(OperatorReply{"c", 1, false, "no", revision}, clock.Now());
  }
  /// Belief and state are there and the first path is given.
  void Begin() {
    person.Receive(MapAt(0));
    person.Receive(StateAt({1, 1}, 10));
    ExpectGuide();
    Accept(1);
    ExpectNothing();
  }

  FakeClock clock;
  SyntheticOperator person;
};

}  // namespace conav::operators
