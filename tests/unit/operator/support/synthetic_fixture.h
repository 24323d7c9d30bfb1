#pragma once

#include <catch2/catch.hpp>
#include <map>
#include <string>

#include "operator/simulated/synthetic_operator.h"
#include "support/drawn_map.h"

/// What the tests of the synthetic operator share: a small map, messages of its world, and a console
/// with a person in front of it.
namespace conav::operators {

inline const BeliefGrid kMap = DrawnMap({"######", "#    #", "# ## #", "#    #", "######"});

/// Edits every difference that a picture shows, in its place.
inline SnapshotReaderParameters FlawlessReader() {
  return {.edit_probability = 1.0,
          .decay_cells = 1e6,
          .path_removal_probability = 1.0,
          .lateral_factor = 1.0,
          .misplacement_probability = 0.0,
          .lapse_probability = 0.0,
          .guess_probability = 0.0};
}

inline SyntheticOperatorParameters Flawless() {
  return {.reader = FlawlessReader(), .glance_rate = 1.0};
}

/// kMap, with walls at `walls`.
inline Belief MapAt(std::uint64_t revision, const std::vector<Cell>& walls = {}) {
  BeliefGrid map = kMap;
  for (const Cell wall : walls) map[wall] = 1.0F;
  return {{0}, "w1", revision, std::move(map), ""};
}

inline RobotState StateAt(Cell cell, std::int64_t stamp, const std::string& robot = "r1") {
  return {.stamp = {stamp}, .world = "w1", .robot = robot, .cell = cell, .goals_left = {{1, 4}}};
}

/// From (1,1): a wall at (1,3), which the map does not have.
inline Snapshot SnapshotOf(std::uint64_t sequence_number, std::int64_t stamp,
                           bool streamed = false) {
  return {.stamp = {stamp},
          .world = "w1",
          .robot = "r1",
          .sequence_number = sequence_number,
          .streamed = streamed,
          .cell = {1, 1},
          .visible = {{{1, 1}, {1, 2}}, {{1, 3}}},
          .path = {{1, 1}},
          .goals_left = {{1, 4}}};
}

inline AttentionRequest Attention(AttentionReason reason, Cell cell, std::uint64_t newest_snapshot,
                                  std::int64_t stamp, std::uint64_t sequence_number = 1) {
  return {{stamp}, "w1", "r1", sequence_number, reason, cell, newest_snapshot, 0.0, 0.0};
}

struct Console {
  explicit Console(const SyntheticOperatorParameters& parameters = Flawless(),
                   const std::map<std::string, std::string>& robots = {{"r1", "w1"}})
      : person(parameters, 1, robots) {}

  /// The next request, which must be there and of type `Request`.
  template <class Request>
  Request Expect() {
    const auto ask = person.Next(clock.Now());
    REQUIRE(ask.has_value());
    CHECK(ask->world == "w1");
    REQUIRE(std::holds_alternative<Request>(ask->body));
    return std::get<Request>(ask->body);
  }
  EditRequest ExpectEdit() { return Expect<EditRequest>(); }
  GuideRequest ExpectGuide() { return Expect<GuideRequest>(); }
  SelectRequest ExpectSelect() { return Expect<SelectRequest>(); }
  void ExpectNothing() { CHECK_FALSE(person.Next(clock.Now()).has_value()); }
  void Show(const Snapshot& snapshot) { person.Receive(snapshot, clock.Now()); }
  void Ask(const AttentionRequest& request) { person.Receive(request, clock.Now()); }
  void Accept(std::uint64_t revision) {
    person.Answered(OperatorReply{"c", 1, true, "", revision}, clock.Now());
  }
  void Refuse(std::uint64_t revision) {
    person.Answered(OperatorReply{"c", 1, false, "no", revision}, clock.Now());
  }
  /// Nothing is asked until then, by the clock.
  void ExpectNothingFor(std::chrono::milliseconds pause) {
    ExpectNothing();
    clock.Advance(pause - std::chrono::milliseconds(1));
    ExpectNothing();
    clock.Advance(std::chrono::milliseconds(1));
  }
  void ShowRobot() {
    person.Receive(MapAt(0));
    person.Receive(StateAt({1, 1}, 10));
  }

  FakeClock clock;
  SyntheticOperator person;
};

/// Belief and state are there and the first path is given.
struct BegunConsole : Console {
  explicit BegunConsole(const SyntheticOperatorParameters& parameters = Flawless())
      : Console(parameters) {
    ShowRobot();
    ExpectGuide();
    Accept(1);
    ExpectNothing();
  }
};

}  // namespace conav::operators
