#include <catch2/catch.hpp>

#include "common/msg/perception_model.h"
#include "planner/methods/make_method.h"
#include "study/experiment/search_experiment.h"

namespace conav::planner {
namespace {

class Player {
 public:
  EpisodeResult Play(MethodKind method, const std::string& person, std::uint64_t seed,
                     const EpisodeOptions& options = {}, const SearchConfig& search = {},
                     const CommunicationConfig& communication = {}) {
    const auto robot = MakeMethod(method, {search, communication}, seed,
                                  std::make_shared<FakePerceptionModel>(), nullptr, clock_);
    return RunEpisode(sim::MakeWorldSpec({.seed = seed}).value(), *robot,
                      operators::ParametersOfKind(person), seed, options,
                      [&](const Situation&) { ++decisions; });
  }

  int decisions = 0;

 private:
  SteadyClock clock_;
};

TEST_CASE("steps are estimated from moves and turning", "[planner][experiment]") {
  CHECK(EstimatedLowLevelSteps(0.0, 0.0) == 0.0);
  CHECK(EstimatedLowLevelSteps(20.0, 10.0) == Approx(140.6 + 37.3));
}

TEST_CASE("an episode ends with all goals, and its figures agree", "[planner][experiment]") {
  Player player;
  const EpisodeResult result = player.Play(MethodKind::kIgMcts, "careful", 3);
  CHECK(result.all_goals);
  CHECK(result.goals_reached == result.goals);
  CHECK(result.moves == static_cast<int>(result.trajectory.size()));
  CHECK(result.moves >= result.optimal_moves);
  CHECK(result.snapshots > 0);
  CHECK(result.guidance == result.snapshots + 1);  // one for each picture, and the first
  CHECK(result.decision_ms.size() == static_cast<std::size_t>(player.decisions));
  CHECK(player.decisions == result.moves + result.blocked + result.snapshots);
}

TEST_CASE("the default search reaches all goals in every maze, and mends the operator's map",
          "[planner][experiment]") {
  int edits = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const EpisodeResult result = Player().Play(MethodKind::kIgMcts, "careful", seed);
    CHECK(result.all_goals);
    CHECK(result.snapshots < 60);
    CHECK(result.perception_queries < 100U * result.decision_ms.size());
    edits += result.edits;
  }
  CHECK(edits >= 36);
}

TEST_CASE("the same maze has the same episode in every version", "[planner][experiment]") {
  const auto [seed, moves, snapshots, edits] =
      GENERATE(table<std::uint64_t, int, int, int>({{1, 21, 1, 0}, {2, 29, 5, 16}, {3, 27, 5, 6}}));
  const EpisodeResult result = Player().Play(MethodKind::kIgMcts, "careful", seed);
  CAPTURE(seed);
  CHECK(result.moves == moves);
  CHECK(result.snapshots == snapshots);
  CHECK(result.edits == edits);
}

TEST_CASE("the printed numbers do not get there", "[planner][experiment]") {
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto result =
        Player().Play(MethodKind::kIgMcts, "careful", seed, {}, {.options = PaperOptions()});
    reached += result.all_goals ? 1 : 0;
  }
  CHECK(reached < 3);
}

TEST_CASE("a robot that follows instructions asks where it is blocked", "[planner][experiment]") {
  const EpisodeResult instructed = Player().Play(MethodKind::kInstruction, "careful", 4);
  CHECK(instructed.all_goals);
  CHECK(instructed.snapshots == 0);
  CHECK(instructed.guidance > 1);
}

TEST_CASE("every communication policy arrives, with pictures as it says", "[planner][experiment]") {
  const auto snapshots = [](const CommunicationConfig& communication) {
    const EpisodeResult result =
        Player().Play(MethodKind::kIgMcts, "careful", 3, {}, {}, communication);
    INFO(communication.policy);
    CHECK(result.all_goals);
    CHECK(result.guidance == result.snapshots + 1);
    return result.snapshots;
  };
  CHECK(snapshots({.policy = "never"}) == 0);
  CHECK(snapshots({.policy = "random", .probability = 0.0}) == 0);
  CHECK(snapshots({.policy = "random", .probability = 0.3}) > 2);
  CHECK(snapshots({.policy = "every", .every_moves = 2}) >
        snapshots({.policy = "every", .every_moves = 6}));
  CHECK(snapshots({.policy = "threshold", .threshold_cells = 0.5}) >
        snapshots({.policy = "threshold", .threshold_cells = 2.0}));
  snapshots({.policy = "when_blocked"});
}

TEST_CASE(
    "an episode ends after its limit of actions, or where the robot waits for somebody silent",
    "[planner][experiment]") {
  Player limited;
  CHECK_FALSE(limited.Play(MethodKind::kIgMcts, "careful", 3, {.action_limit = 5}).all_goals);
  CHECK(limited.decisions == 5);
  Player silent;
  const EpisodeResult result = silent.Play(MethodKind::kInstruction, "silent", 4);
  CHECK_FALSE(result.all_goals);
  CHECK(result.moves == 0);
  CHECK(result.guidance == 0);
  CHECK(silent.decisions == 1);
}

TEST_CASE("the optimal tour is the shortest on the true map", "[planner][experiment]") {
  sim::WorldSpec world;
  world.truth = OccupancyGrid(5, 7, Occupancy::kOccupied);
  for (int column = 1; column <= 5; ++column) world.truth[{1, column}] = Occupancy::kFree;
  world.truth[{2, 1}] = world.truth[{3, 1}] = Occupancy::kFree;
  world.human_map = world.truth;
  world.starts = {{1, 3}};
  world.goals = {{{1, 5}, {3, 1}}};
  CHECK(OptimalMoves(world) == 2 + 6);
}

}  // namespace
}  // namespace conav::planner
