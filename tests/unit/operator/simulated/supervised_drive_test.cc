// The synthetic person and a robot that carries out every command, in a closed loop without a bus.
#include <catch2/catch.hpp>

#include "operator/simulated/synthetic_operator.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

const BeliefGrid kTruth =
    DrawnMap({"#############", "#   #   #   #", "# # # # # # #", "# #   #   # #", "# ####### # #",
              "#   #     # #", "### # ##### #", "#   # #     #", "# ### # ### #", "#     #   # #",
              "# ##### # # #", "#       #   #", "#############"});
const std::vector<Cell> kGoals = {{11, 11}, {1, 11}, {5, 9}, {7, 1}};

/// The truth with every seventh cell or so inside of the border the other way.
BeliefGrid WrongMap(Random& random) {
  BeliefGrid map = kTruth;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (!map.OnBorder(cell) && random.Chance(0.15)) map[cell] = 1.0F - map[cell];
  }
  return map;
}

int WrongCells(const BeliefGrid& map) {
  int wrong = 0;
  for (std::size_t i = 0; i < map.size(); ++i) wrong += map.values()[i] != kTruth.values()[i];
  return wrong;
}

/// Robot r1 in the truth, the person with a wrong map, and an operator service that accepts all.
class Drive {
 public:
  explicit Drive(std::uint64_t seed) : person_({}, seed, {{"r1", "w1"}}) {
    Random random(seed);
    belief_ = {{0}, "w1", 0, WrongMap(random), ""};
    belief_.wall_probability[{1, 1}] = 0.0F;
    state_.world = "w1";
    state_.robot = "r1";
    state_.cell = {1, 1};
    state_.goals_left = kGoals;
    person_.Receive(belief_);
    person_.Receive(state_);
    wrong_before_ = Wrong();
    LetThePersonAct();
  }

  /// Moves one cell, sends a streamed picture from there; false when the cell is a wall.
  bool Move(Cell target) {
    ++moves_;
    ++state_.stamp.nanoseconds;
    const bool moved = kTruth[target] < 0.5F;
    if (moved) {
      const double heading = HeadingTowards(state_.cell, target);
      const Cell left = state_.cell;
      state_.cell = target;
      std::erase(state_.goals_left, target);
      ++state_.snapshots;
      Snapshot snapshot;
      snapshot.stamp = state_.stamp;
      snapshot.world = state_.world;
      snapshot.robot = state_.robot;
      snapshot.sequence_number = state_.snapshots;
      snapshot.streamed = true;
      snapshot.cell = target;
      snapshot.heading_rad = heading;
      snapshot.visible = CastView(truth_, {target, heading});
      snapshot.path = {left, target};
      snapshot.goals_left = state_.goals_left;
      person_.Receive(snapshot, {});
    }
    person_.Receive(state_);
    LetThePersonAct();
    return moved;
  }

  void Ask(AttentionReason reason, Cell cell) {
    const std::size_t before = paths_;
    person_.Receive(AttentionRequest{state_.stamp, "w1", "r1", ++asked_, reason, cell,
                                     state_.snapshots, 0.0, 0.0},
                    {});
    LetThePersonAct();
    REQUIRE(paths_ == before + 1);
  }

  const std::vector<Cell>& path() const { return path_; }
  Cell cell() const { return state_.cell; }
  bool done() const { return state_.goals_left.empty(); }
  int moves() const { return moves_; }
  int wrong_before() const { return wrong_before_; }
  int Wrong() const { return WrongCells(belief_.wall_probability); }

 private:
  void LetThePersonAct() {
    while (const auto ask = person_.Next({})) {
      OperatorReply reply{"c", 1, true, "", 0};
      if (const auto* edit = std::get_if<EditRequest>(&ask->body)) {
        REQUIRE(edit->base_revision == belief_.revision);
        for (const CellEdit& e : edit->edits) {
          REQUIRE_FALSE(kTruth.OnBorder(e.cell));
          belief_.wall_probability[e.cell] = e.wall ? 1.0F : 0.0F;
        }
        reply.revision = ++belief_.revision;
        person_.Receive(belief_);
      } else {
        path_ = std::get<GuideRequest>(ask->body).path;
        reply.revision = ++paths_;
        REQUIRE(path_.front() == state_.cell);
      }
      person_.Answered(reply, {});
    }
  }

  SyntheticOperator person_;
  OccupancyGrid truth_ = ToOccupancy(kTruth);
  Belief belief_;
  RobotState state_;
  std::vector<Cell> path_;
  std::size_t paths_ = 0;
  std::uint64_t asked_ = 0;
  int moves_ = 0;
  int wrong_before_ = 0;
};

TEST_CASE("A robot that follows the paths, whole or step by step, reaches all goals",
          "[simulated]") {
  const bool step_by_step = GENERATE(false, true);
  int wrong_before = 0;
  int wrong_after = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed, step_by_step);
    Drive drive(seed);
    std::size_t next = 1;
    while (!drive.done()) {
      REQUIRE(drive.moves() < 1000);
      REQUIRE(next < drive.path().size());  // a path covers all goals that are left
      const Cell target = drive.path()[next++];
      const bool moved = drive.Move(target);
      if (moved && !step_by_step) continue;
      if (moved) {
        drive.Ask(AttentionReason::kNoGuidance, drive.cell());
      } else {
        drive.Ask(AttentionReason::kBlocked, target);
      }
      next = 1;
    }
    wrong_before += drive.wrong_before();
    wrong_after += drive.Wrong();
  }
  CAPTURE(wrong_before, wrong_after);
  CHECK(wrong_after < 0.8 * wrong_before);  // the map gets better, too
}

TEST_CASE("The careful default makes a wrong map better, at about one edit a picture",
          "[simulated]") {
  constexpr int kSnapshots = 25;
  int before = 0;
  int after = 0;
  int edits = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    BeliefGrid belief = WrongMap(random);
    const int wrong = WrongCells(belief);
    SnapshotReader reader({}, seed);
    for (int i = 0; i < kSnapshots; ++i) {
      Snapshot snapshot;
      do {
        snapshot.cell = kTruth.CellAt(static_cast<std::size_t>(random.Uniform(0, 168)));
      } while (IsWall(kTruth, snapshot.cell));
      snapshot.path = {snapshot.cell};
      snapshot.heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 7)), 8);
      snapshot.visible = CastView(ToOccupancy(kTruth), {snapshot.cell, snapshot.heading_rad});
      for (const CellEdit& edit : reader.Read(belief, snapshot, {})) {
        belief[edit.cell] = edit.wall ? 1.0F : 0.0F;
        ++edits;
      }
    }
    CHECK(WrongCells(belief) < wrong);
    before += wrong;
    after += WrongCells(belief);
  }
  CAPTURE(before, after, edits);
  CHECK(after < 0.5 * before);
  CHECK(edits > 0.3 * kSnapshots * 40);
  CHECK(edits < 1.5 * kSnapshots * 40);
}

}  // namespace
}  // namespace conav::operators
