#include "planner/methods/ig_mcts_method.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "common/msg/perception_model.h"
#include "common/runtime/file.h"
#include "planner/decision/traffic.h"
#include "planner/methods/make_method.h"
#include "support/temporary_folder.h"

using namespace conav;
using namespace conav::planner;

namespace {

/// A robot in a closed cell at the eastern end: all it can do is to show views, and what the operator
/// does not know of is the wall west of it.
Situation Boxed(int columns = 5) {
  const Cell robot{1, columns - 2};
  Situation situation;
  situation.state.robot = "r1";
  situation.state.cell = robot;
  situation.state.path = {robot};
  situation.state.heading_rad = std::numbers::pi;
  situation.state.goals_left = {{1, 1}};
  situation.map.cells = OccupancyGrid(3, columns, Occupancy::kOccupied);
  situation.map.cells[{1, 1}] = Occupancy::kFree;
  situation.map.cells[robot] = Occupancy::kFree;
  situation.belief.wall_probability = BeliefGrid(3, columns, 1.0F);
  situation.guidance.emplace();
  for (int column = robot.column; column >= 1; --column) {
    situation.belief.wall_probability[{1, column}] = 0.0F;
    situation.guidance->path.push_back({1, column});
  }
  situation.guided_before = true;
  return situation;
}

double MostInformation(const Decision& decision) {
  double most = 0.0;
  for (const SearchAction& action : decision.report.actions) {
    most = std::max(most, action.information_gain);
  }
  return most;
}

struct Bench {
  explicit Bench(const SearchConfig& config = Config(),
                 std::shared_ptr<BeliefEstimate> estimate = nullptr,
                 std::optional<CommunicationPolicy> policy = std::nullopt)
      : method(config, 1, std::make_shared<FakePerceptionModel>(), clock, std::move(estimate),
               std::move(policy)) {}
  Decision Decide() { return method.Decide(situation, StopToken()); }
  double HeadingDecided() {
    const Decision decision = Decide();
    REQUIRE(decision.action);
    REQUIRE(decision.action->kind == CommandKind::kTransmitView);
    CHECK(decision.attention == AttentionReason::kSnapshot);
    return decision.action->heading_rad;
  }

  static SearchConfig Config() {
    SearchConfig config;
    config.options.iterations = 300;
    config.options.min_information = 0.0;
    config.options.optional_pictures = false;  // in the box there is nothing else to do
    return config;
  }

  Situation situation = Boxed();
  FakeClock clock;
  IgMctsMethod method;
};

TEST_CASE("a search has a name or is a file with its keys", "[planner][methods]") {
  CHECK(SearchFrom("default").options.iterations == 2000);
  CHECK(SearchFrom("default").mapping_value == 0.5);
  CHECK(SearchFrom("building").mapping_value == 1.0);  // the choice was made in mazes
  CHECK(SearchFrom("waterway").mapping_value == 1.0);
  CHECK(SearchFrom("paper").mapping_value == 1.0);
  CHECK(SearchFrom("paper").options.iterations == 100);
  const SearchConfig paper = SearchFrom("paper-2000");
  CHECK(paper.options.iterations == 2000);
  CHECK(paper.options.reward.communication_cost == 10.0);
  CHECK(paper.reliability_prior == 0.0);
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "search.yaml";
  REQUIRE(WriteFile(file, "search: {preset: paper, iterations: 7}\n"));
  const SearchConfig read = SearchFrom(file.string());
  CHECK(read.options.iterations == 7);
  CHECK_FALSE(read.options.optional_pictures);
  CHECK_THROWS_WITH(SearchFrom("fast"), Catch::Contains("paper-2000"));
  REQUIRE(WriteFile(file, "search: {iteration: 7}\n"));
  CHECK_THROWS_WITH(SearchFrom(file.string()), Catch::Contains("iteration"));
}

}  // namespace

TEST_CASE("a view counts as sent once the robot shows it", "[planner][ig-mcts]") {
  Bench bench;
  const double first = bench.HeadingDecided();
  CHECK(bench.HeadingDecided() == first);  // its command came to nothing
  bench.situation.state.snapshots = 1;
  CHECK(bench.HeadingDecided() != first);
}

TEST_CASE("an answer is worth the goal that it leads to, less for each that led nowhere",
          "[planner][ig-mcts]") {
  Bench bench;
  const double known = MostInformation(bench.Decide());
  bench.situation.lacks_way = true;
  const double first = MostInformation(bench.Decide()) - known;
  CHECK(first == Approx(bench.Config().options.reward.goal));
  bench.situation.state.snapshots = 1;
  CHECK(MostInformation(bench.Decide()) < 0.6 * first);
  bench.situation.state.goals_reached = {{1, 2}};
  CHECK(MostInformation(bench.Decide()) > 0.9 * first);
}

TEST_CASE("pictures of hidden goals are worth less the more of them showed none",
          "[planner][ig-mcts]") {
  Bench bench;
  bench.situation.map.cells[{1, 2}] = Occupancy::kFree;  // which a picture shows
  const double known = MostInformation(bench.Decide());
  bench.situation.state.goals_total = 2;
  bench.situation.goals_to_find = 2;
  const double first = MostInformation(bench.Decide());
  CHECK(first > 10.0 * known);
  bench.situation.state.snapshots = 1;
  const double second = MostInformation(bench.Decide());
  CHECK(second < 0.9 * first);
  CHECK(second > known);
}

TEST_CASE("the camera's field of view decides what a picture is worth", "[planner][ig-mcts]") {
  // A slit of a camera sees the wall from fewer headings.
  const auto worth_something = [](double fov_rad) {
    Bench bench;
    bench.situation.lens.horizontal_fov_rad = fov_rad;
    bench.situation.lens.vertical_fov_rad = 0.05;
    const Decision decision = bench.Decide();
    return std::count_if(decision.report.actions.begin(), decision.report.actions.end(),
                         [](const SearchAction& action) { return action.information_gain > 0.01; });
  };
  CHECK(worth_something(0.1) > 0);
  CHECK(worth_something(0.1) < worth_something(1.9));
}

TEST_CASE("a robot whose camera is silent is not asked for pictures", "[planner][ig-mcts]") {
  Bench bench;
  bench.situation.sends_no_pictures = true;
  const Decision decision = bench.Decide();
  CHECK((!decision.action || decision.action->kind == CommandKind::kMove));
}

TEST_CASE("a robot waits a moment for the one that has to make room, then looks for another way",
          "[planner][ig-mcts]") {
  Bench bench;
  bench.situation.map.cells[{1, 2}] = Occupancy::kFree;
  bench.situation.neighbours = {{"r2", {1, 2}, true, {}}};
  CHECK_FALSE(bench.Decide().action.has_value());
  bench.clock.Advance(kPatience);
  CHECK(bench.Decide().report.iterations == 300);
}

TEST_CASE("with an estimate the published map counts only at the start",
          "[planner][ig-mcts][belief_estimate]") {
  const auto estimate = std::make_shared<BeliefEstimate>(std::make_shared<FakePerceptionModel>());
  Bench bench(Bench::Config(), estimate);
  const BeliefGrid first = bench.situation.belief.wall_probability;
  REQUIRE(bench.Decide().action);
  bench.situation.belief.wall_probability[{1, 2}] = 1.0F;  // an edit of the operator's
  REQUIRE(bench.Decide().action);                          // and no picture was sent
  CHECK(estimate->Now(first) == first);
  bench.situation.state.snapshots = 1;
  REQUIRE(bench.Decide().action);
  const BeliefGrid moved = estimate->Now(first);
  CHECK_FALSE(moved == first);
  REQUIRE(bench.Decide().action);
  CHECK(estimate->Now(first) == moved);
}

TEST_CASE("an operator who does nothing with pictures makes further ones worth less",
          "[planner][ig-mcts]") {
  const double prior = GENERATE(0.0, 1.0);
  SearchConfig config = Bench::Config();
  config.reliability_prior = prior;
  Bench bench(config);
  const double first = MostInformation(bench.Decide());
  REQUIRE(first > 0.1);
  bench.situation.state.snapshots = 1;  // sent, and nothing came of it
  const double second = MostInformation(bench.Decide());
  if (prior > 0.0) {
    CHECK(second < 0.8 * first);
  } else {
    CHECK(second == first);
  }
}

TEST_CASE("a world that restarts with a map of another size is judged as a new one",
          "[planner][ig-mcts]") {
  const auto [before, columns] = GENERATE(table<int, int>({{5, 7}, {7, 5}}));
  Bench fresh;
  fresh.situation = Boxed(columns);
  Bench bench;
  bench.situation = Boxed(before);
  for (std::uint64_t snapshots = 0; snapshots < 3; ++snapshots) {
    bench.situation.state.snapshots = snapshots;
    bench.Decide();
  }
  bench.situation = Boxed(columns);
  CHECK(MostInformation(bench.Decide()) == MostInformation(fresh.Decide()));
}

TEST_CASE("where the operator's map is estimated, their reliability is not measured",
          "[planner][ig-mcts]") {
  const auto second_decision = [](double prior) {
    SearchConfig config = Bench::Config();
    config.reliability_prior = prior;
    Bench bench(config, std::make_shared<BeliefEstimate>(std::make_shared<FakePerceptionModel>()));
    bench.Decide();
    bench.situation.state.snapshots = 1;
    return bench.Decide().report.actions;
  };
  CHECK(second_decision(1.0) == second_decision(0.0));
}

TEST_CASE("a policy sends the view with the largest expected information, and no view twice",
          "[planner][ig-mcts][communication]") {
  Bench bench(Bench::Config(), nullptr,
              CommunicationPolicy({.policy = "every", .every_moves = 1}, 1));
  bench.situation.state.path = {{1, 4}, {1, 3}};
  std::vector<double> information;
  std::vector<double> headings;
  for (std::uint64_t snapshots = 0; snapshots < 8; ++snapshots) {
    bench.situation.state.snapshots = snapshots;
    const Decision decision = bench.Decide();
    REQUIRE(decision.action);
    CHECK(decision.action->kind == CommandKind::kTransmitView);
    CHECK(decision.attention == AttentionReason::kSnapshot);
    CHECK(decision.report.actions.at(0).information_gain == decision.expected_information);
    CHECK(decision.report.chosen == 0);
    information.push_back(decision.expected_information);
    headings.push_back(decision.action->heading_rad);
  }
  CHECK(std::is_sorted(information.rbegin(), information.rend()));
  CHECK(information.front() > 0.1);
  std::sort(headings.begin(), headings.end());
  CHECK(std::adjacent_find(headings.begin(), headings.end()) == headings.end());
  bench.situation.state.snapshots = 8;
  CHECK_FALSE(bench.Decide().action);                      // nothing left, nowhere to go
  bench.situation.belief.wall_probability[{1, 2}] = 0.5F;  // the views that show it count again
  CHECK(bench.Decide().action);
}

TEST_CASE("a threshold is in cells, whatever one is worth to the search", "[planner][ig-mcts]") {
  SearchConfig config = Bench::Config();
  config.mapping_value = GENERATE(0.0, 0.5, 8.0);
  Bench bench(config, nullptr,
              CommunicationPolicy({.policy = "threshold", .threshold_cells = 0.5}, 1));
  CHECK(bench.Decide().expected_information > 0.5);
}

TEST_CASE("with a policy the search moves where none is wanted or worth it",
          "[planner][ig-mcts][communication]") {
  const double threshold = GENERATE(0.0, 1000.0);
  const CommunicationPolicy policy(
      {.policy = threshold > 0.0 ? "threshold" : "never", .threshold_cells = threshold}, 1);
  Bench bench(Bench::Config(), nullptr, policy);
  bench.situation.map.cells[{1, 2}] = Occupancy::kFree;
  const Decision decision = bench.Decide();
  REQUIRE(decision.action);
  CHECK(decision.action->kind == CommandKind::kMove);
  CHECK(decision.action->target == Cell{1, 2});
  CHECK(decision.report.iterations == 300);
  CHECK(decision.report.perception_model == "none");
  for (const SearchAction& action : decision.report.actions) {
    CHECK(action.kind == CommandKind::kMove);
  }
}

TEST_CASE("no preset lets a search send pictures where a policy decides on them",
          "[planner][ig-mcts][communication]") {
  SearchConfig config;
  config.options = PaperOptions();
  Bench bench(config, nullptr, CommunicationPolicy({.policy = "never"}, 1));
  CHECK_FALSE(bench.Decide().action);  // boxed in
}

TEST_CASE("a path guides as long as no wall is known on it, or it must guide all the same",
          "[planner][ig-mcts]") {
  struct Row {
    bool wall, withdrawn, guides_anyway;
    std::size_t cells;
    bool guided_before;
  };
  for (const Row& row : std::vector<Row>{{false, false, false, 5, true},
                                         {true, false, false, 0, false},
                                         {true, false, true, 5, true},
                                         {false, true, false, 0, true}}) {
    Situation situation;  // a room of which the robot has seen three cells
    situation.state.cell = {2, 1};
    situation.state.goals_left = {{2, 5}};
    situation.map.cells = OccupancyGrid(5, 7, Occupancy::kUnknown);
    for (const int column : {1, 2, 3}) situation.map.cells[{2, column}] = Occupancy::kFree;
    situation.belief.wall_probability = BeliefGrid(5, 7, 0.0F);
    situation.guidance = Guidance{.path = {{2, 1}, {2, 2}, {2, 3}, {2, 4}, {2, 5}}};
    situation.guided_before = true;
    if (row.wall) situation.map.cells[{2, 4}] = Occupancy::kOccupied;
    if (row.withdrawn) situation.guidance.reset();
    const SituationProblem problem(
        situation, std::make_shared<const BeliefGrid>(situation.belief.wall_probability), {},
        ViewsFor(situation, 8), {.blocked_path_guides = row.guides_anyway});
    CAPTURE(row.wall, row.withdrawn, row.guides_anyway);
    CHECK(problem.get()->guidance.size() == row.cells);
    CHECK(problem.get()->guided_before == row.guided_before);
  }
}

TEST_CASE("what one robot's picture tells, or is expected to tell, another one need not show",
          "[planner][ig-mcts][belief]") {
  const bool estimated = GENERATE(false, true);
  const auto estimate =
      estimated ? std::make_shared<BeliefEstimate>(std::make_shared<FakePerceptionModel>())
                : nullptr;
  SearchConfig config;
  config.options.iterations = 300;
  config.mapping_value = 1.0;
  // West and east of a wall that the operator does not know of, at (1,2).
  Bench first(config, estimate);
  first.situation.state.cell = {1, 1};
  first.situation.state.path = {{1, 1}};
  first.situation.state.heading_rad = 0.0;
  first.situation.state.goals_left = {{1, 3}};
  Bench second(config, estimate);
  const double before = MostInformation(second.Decide());
  REQUIRE(before > 0.3);
  const Decision sent = first.Decide();
  REQUIRE(sent.action);
  REQUIRE(sent.action->kind == CommandKind::kTransmitView);
  REQUIRE(sent.expected_information > 0.3);
  first.situation.state.snapshots = 1;
  if (estimated) {
    first.Decide();  // notes that it was sent
  } else {
    second.situation.belief.wall_probability[{1, 2}] = 1.0F;  // the answer: one map for both
  }
  CHECK(MostInformation(second.Decide()) < (estimated ? 0.7 * before : 0.01));
}
