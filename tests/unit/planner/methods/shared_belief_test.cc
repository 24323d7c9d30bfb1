// What one robot's picture is still worth after another one has sent its own: the operator's map is
// one for all robots of a world.
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/msg/perception_model.h"
#include "planner/methods/ig_mcts_method.h"

using namespace conav;
using namespace conav::planner;

namespace {

constexpr Cell kMistake{1, 2};  // a wall that the operator does not know of, between the robots

/// A robot in a closed cell west or east of the mistake: all it can do is to show views.
Situation Beside(const std::string& robot, Cell cell) {
  Situation situation;
  situation.state.robot = robot;
  situation.state.cell = cell;
  situation.state.path = {cell};
  situation.state.goals_left = {{1, 1}, {1, 3}};
  std::erase(situation.state.goals_left, cell);
  situation.map.cells = OccupancyGrid(3, 5, Occupancy::kOccupied);
  situation.map.cells[{1, 1}] = Occupancy::kFree;
  situation.map.cells[{1, 3}] = Occupancy::kFree;
  situation.belief.wall_probability = BeliefGrid(3, 5, 1.0F);
  for (const int column : {1, 2, 3}) situation.belief.wall_probability[{1, column}] = 0.0F;
  return situation;
}

double MostInformation(const Decision& decision) {
  double most = 0.0;
  for (const SearchAction& action : decision.report.actions) {
    most = std::max(most, action.information_gain);
  }
  return most;
}

struct TwoRobots {
  explicit TwoRobots(std::shared_ptr<BeliefEstimate> estimate = nullptr)
      : first_method(Config(), 1, model, clock, estimate),
        second_method(Config(), 2, model, clock, estimate) {}

  static SearchConfig Config() {
    SearchConfig config;
    config.options.iterations = 300;
    return config;
  }
  /// The first robot sends its best view.
  void SendPicture() {
    const Decision decision = first_method.Decide(first, StopToken());
    REQUIRE(decision.action);
    REQUIRE(decision.action->kind == CommandKind::kTransmitView);
    REQUIRE(decision.expected_information > 0.3);
    first.state.snapshots = 1;
  }
  double SecondsInformation() { return MostInformation(second_method.Decide(second, StopToken())); }

  std::shared_ptr<FakePerceptionModel> model = std::make_shared<FakePerceptionModel>();
  FakeClock clock;
  Situation first = Beside("r1", {1, 1});
  Situation second = Beside("r2", {1, 3});
  IgMctsMethod first_method;
  IgMctsMethod second_method;
};

}  // namespace

TEST_CASE("what the operator learned from one robot's picture, another one need not show",
          "[planner][ig-mcts][belief]") {
  TwoRobots robots;
  REQUIRE(robots.SecondsInformation() > 0.3);
  robots.SendPicture();
  // The answer: one map for both.
  robots.second.belief.wall_probability[kMistake] = 1.0F;
  CHECK(robots.SecondsInformation() < 0.01);
}

TEST_CASE("where the operator's map is estimated, one robot's picture lowers another one's worth",
          "[planner][ig-mcts][belief]") {
  TwoRobots robots(std::make_shared<BeliefEstimate>(std::make_shared<FakePerceptionModel>()));
  const double before = robots.SecondsInformation();
  REQUIRE(before > 0.3);
  robots.SendPicture();
  robots.first_method.Decide(robots.first, StopToken());  // notes that it was sent
  CHECK(robots.SecondsInformation() < 0.7 * before);
}
