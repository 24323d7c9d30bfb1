// What the synthetic operator makes of attention requests.
#include <catch2/catch.hpp>

#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

TEST_CASE("A blocked cell becomes a wall for certain and the next path avoids it",
          "[operator][simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.planner.wall_crossing_cost = 0.0;
  Desk desk(parameters);
  desk.Begin();
  desk.person.Receive(Attention(AttentionReason::kBlocked, {1, 2}, 0, 10), desk.clock.Now());
  CHECK(desk.ExpectEdit() == EditRequest{0, {{{1, 2}, true}}});
  desk.Accept(1);
  BeliefGrid edited = kMap;
  edited[{1, 2}] = 1.0F;
  desk.person.Receive(MapAt(1, edited));
  // Crossing walls is free here, but not this one.
  CHECK(desk.ExpectGuide().path ==
        std::vector<Cell>{{1, 1}, {2, 1}, {2, 2}, {2, 3}, {1, 3}, {1, 4}});
  desk.Accept(2);

  // A picture that seems to show it free does not make the person forget.
  Snapshot picture = SnapshotOf(1, 20);
  picture.visible = {{{1, 2}}, {}};
  desk.person.Receive(picture, desk.clock.Now());
  desk.ExpectGuide();
}

TEST_CASE("A cell that another robot holds is not marked as a wall", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  RobotState state = StateAt({1, 1}, 20);
  state.command_outcome = CommandOutcome::kOccupied;
  state.command_cell = {1, 2};
  desk.person.Receive(state);
  desk.person.Receive(Attention(AttentionReason::kBlocked, {1, 2}, 0, 20), desk.clock.Now());
  desk.ExpectGuide();
}

TEST_CASE("A robot without guidance gets a path from where it is", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(StateAt({1, 2}, 30));
  desk.person.Receive(Attention(AttentionReason::kNoGuidance, {1, 2}, 0, 30), desk.clock.Now());
  CHECK(desk.ExpectGuide().path == std::vector<Cell>{{1, 2}, {1, 3}, {1, 4}});
}

TEST_CASE("An attention request waits for the pictures and the state that it speaks of",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(Attention(AttentionReason::kNoGuidance, {1, 1}, 2, 30), desk.clock.Now());
  desk.ExpectNothing();
  Snapshot first = SnapshotOf(1, 20, true);
  first.visible = {};
  desk.person.Receive(first, desk.clock.Now());
  desk.ExpectNothing();
  desk.person.Receive(SnapshotOf(2, 20, true), desk.clock.Now());
  CHECK(desk.ExpectEdit().edits.size() == 1);
  desk.Accept(0);
  desk.ExpectNothing();
  desk.person.Receive(StateAt({1, 2}, 30));
  const GuideRequest guide = desk.ExpectGuide();
  CHECK(guide.path.front() == Cell{1, 2});
  CHECK(guide.answers_snapshot == 2);
}

TEST_CASE("An attention request whose pictures never come is answered after a while",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(Attention(AttentionReason::kNoGuidance, {1, 1}, 2, 30), desk.clock.Now());
  desk.clock.Advance(1999ms);
  desk.ExpectNothing();
  desk.clock.Advance(1ms);
  CHECK(desk.ExpectGuide().answers_snapshot == 0);
}

TEST_CASE("A repeated attention request is answered once, a newer one replaces an older one",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  const auto ask = Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10);
  desk.person.Receive(ask, desk.clock.Now());
  desk.person.Receive(ask, desk.clock.Now());
  desk.person.Receive(Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10, 2), desk.clock.Now());
  desk.ExpectGuide();
  desk.Accept(2);
  desk.ExpectNothing();
  CHECK(desk.person.open() == 0);
}

}  // namespace
}  // namespace conav::operators
