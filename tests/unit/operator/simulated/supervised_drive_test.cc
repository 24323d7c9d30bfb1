// The synthetic person and a robot that does as it is told, in a closed loop without a bus.
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

OccupancyGrid TruthMap() {
  OccupancyGrid map(kTruth.rows(), kTruth.columns());
  for (std::size_t i = 0; i < map.size(); ++i) {
    map.values()[i] = kTruth.values()[i] > 0.5F ? Occupancy::kOccupied : Occupancy::kFree;
  }
  return map;
}

/// Robot r1 in the truth, the person with a wrong map, and an operator service that accepts all.
class Drive {
 public:
  explicit Drive(std::uint64_t seed) : person_({}, seed, {{"r1", "w1"}}) {
    Random random(seed);
    belief_ = {{0}, "w1", 0, kTruth, ""};
    for (std::size_t i = 0; i < kTruth.size(); ++i) {
      const Cell cell = kTruth.CellAt(i);
      float& wall = belief_.wall_probability[cell];
      if (!kTruth.OnBorder(cell) && cell != Cell{1, 1} && random.Chance(0.15)) wall = 1.0F - wall;
    }
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
      Snapshot picture;
      picture.stamp = state_.stamp;
      picture.world = state_.world;
      picture.robot = state_.robot;
      picture.sequence_number = state_.snapshots;
      picture.streamed = true;
      picture.cell = target;
      picture.heading_rad = heading;
      picture.visible = CastView(truth_, {target, heading});
      picture.path = {left, target};
      picture.goals_left = state_.goals_left;
      person_.Receive(picture, {});
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
  int Wrong() const {
    int wrong = 0;
    for (std::size_t i = 0; i < kTruth.size(); ++i) {
      wrong += kTruth.values()[i] != belief_.wall_probability.values()[i];
    }
    return wrong;
  }

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
  OccupancyGrid truth_ = TruthMap();
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

}  // namespace
}  // namespace conav::operators
