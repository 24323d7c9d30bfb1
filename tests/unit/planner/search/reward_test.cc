#include "planner/search/reward.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "planner/search/search_tree.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// With the paper's cost.
const RewardOptions kOptions{.communication_cost = 10.0};

TEST_CASE("each term by hand", "[planner][search]") {
  CHECK(EnvironmentReward(true, kOptions) == 100.0);
  CHECK(EnvironmentReward(false, kOptions) == -1.0);
  CHECK(EnvironmentReward(false, kOptions, 2.5) == -2.5);  // for each step of the move
  CHECK(EnvironmentReward(true, kOptions, 2.5) == 100.0);
  CHECK(GuidanceReward(GuidanceWeight(true, true), 7) == 0.0);
  CHECK(GuidanceReward(GuidanceWeight(true, false), 1) == 0.0);
  CHECK(GuidanceReward(GuidanceWeight(true, false), 7) == Approx(-1.9459101));
  CHECK(GuidanceReward(GuidanceWeight(false, false), 7) == 0.0);  // no path so far to be off from
  CHECK(SmoothnessReward(0) == 0.0);
  CHECK(SmoothnessReward(3) == -3.0);
  CHECK(CommunicationCost(0, kOptions) == 10.0);
  CHECK(CommunicationCost(4, kOptions) == 14.0);  // 1 per cell of the path not visited
  CHECK(CommunicationCost(4, {.communication_cost = 0.5}) == Approx(0.7));
  CHECK(CommunicationCost(4, {.communication_cost = 60.0, .communication_guidance = 0.0}) == 60.0);
}

TEST_CASE("a communication gives its information less its cost", "[planner][search]") {
  TextWorld world({"######", "#S..G#", "######"});
  world.problem.guidance = {{1, 1}, {1, 2}, {1, 3}, {1, 4}};
  const PathState path(world.problem);
  CHECK(RewardOfSnapshot(path, 0.0, 1.75, kOptions).Sum() == Approx(1.75 - 13.0));
  RewardOptions with_step = kOptions;
  with_step.communication_step = -1.0;
  CHECK(RewardOfSnapshot(path, 0.0, 1.75, with_step).Terms() ==
        RewardTerms{.steps = -1.0, .information = 1.75, .communication = -13.0});
}

TEST_CASE("a view costs the turn away from where the robot looks", "[planner][search]") {
  TextWorld world({"#####", "#S.G#", "#...#", "#####"});
  world.problem.heading_rad = 0.5;
  PathState path(world.problem);
  RewardOptions options = kOptions;
  options.view_turn = 2.0;
  CHECK(TurnCost(path, 0.2, options) == Approx(0.6));
  CHECK(RewardOfSnapshot(path, 0.2, 0.0, options).Sum() == Approx(-10.0 - 0.6));
  path.Go(world.EdgeBetween({1, 1}, {2, 1}));  // south
  CHECK(TurnCost(path, 0.0, options) == Approx(std::numbers::pi));
  CHECK(TurnCost(path, std::numbers::pi, options) == Approx(std::numbers::pi));
  path.Stay();
  CHECK(TurnCost(path, -std::numbers::pi / 2.0, options) == Approx(0.0).margin(1e-12));
  path.Go(world.EdgeBetween({2, 1}, {2, 2}));
  CHECK(TurnCost(path, 0.0, options) == Approx(0.0).margin(1e-12));
  path.TakeBack(0);
  CHECK(TurnCost(path, 0.5, options) == Approx(0.0).margin(1e-12));
}

// What a value is made of: each return is carried as a sum of terms through rollout and backup.

void CheckTermsAddUp(const SearchResult& result) {
  REQUIRE(result.has_terms);
  for (const SearchAction& action : result.actions) {
    CHECK(action.terms.Sum() == Approx(action.mean_value).epsilon(1e-9).margin(1e-9));
  }
}

TEST_CASE("the terms of a move's value, worked out by hand", "[planner][search]") {
  struct Row {
    const char* name;
    std::string_view corridor;
    RewardTerms terms;
    std::vector<Cell> goals{}, guidance{}, path{};
    double progress = 0.0;
  };
  for (const Row& row : std::vector<Row>{
           {"a goal beside the robot, and nothing else counts", "#SG#", {.goals = 100.0}},
           {"a step costs, the goal behind it is discounted",
            "#S.G#",
            {.goals = 0.5 * 100.0, .steps = -1.0}},
           {"a wall that may be in the way weighs the goal by its feasibility",
            "#S.?#",
            {.goals = 0.5 * 0.5 * 100.0, .steps = -1.0},
            {{1, 3}}},
           {"progress is the steps saved",
            "#S..G#",
            {.goals = 25.0, .steps = -1.0 - 0.5, .progress = 2.0 + 0.5 * 2.0 + 0.25 * 2.0},
            {},
            {},
            {},
            2.0},
           {"off the operator's path guidance grows with the length of the way",
            "#S..G#",
            {.goals = 25.0, .steps = -1.5, .guidance = -std::log(2.0) - 0.5 * std::log(3.0)},
            {},
            {{1, 1}, {1, 4}}},
           {"a cell that is entered again counts in smoothness",
            "#SG#",
            {.goals = 100.0, .smoothness = -1.0},
            {},
            {},
            {{1, 2}, {1, 1}}}}) {
    const std::string wall(row.corridor.size(), '#');
    TextWorld world({wall, row.corridor, wall}, kNoViews);
    if (!row.goals.empty()) world.problem.goals_left = row.goals;
    world.problem.guidance = row.guidance;
    world.problem.path = row.path;
    SearchOptions options = ByHand(1);
    options.expansion = Expansion::kChain;  // all the way to the goal in one iteration
    options.reward.progress = row.progress;
    const RewardTerms terms = Decide(world.problem, options).actions.at(0).terms;
    CAPTURE(row.name);
    using T = RewardTerms;
    for (double T::*term : {&T::goals, &T::steps, &T::progress, &T::guidance, &T::smoothness,
                            &T::information, &T::communication}) {
      CHECK(terms.*term == Approx(row.terms.*term));
    }
  }
}

struct Maze {
  TextWorld world{
      {"#########", "#S.?..?.#", "#.#.#.#.#", "#G.?.#..#", "#.##..#.#", "#....?.G#", "#########"},
      {"#########", "#S#.#...#", "#.#.#.#.#", "#G...#..#", "#.#...#.#", "#..#...G#", "#########"}};
  Maze() { world.problem.guidance = {{1, 1}, {1, 2}, {1, 3}, {2, 3}, {3, 3}, {3, 4}}; }
};

TEST_CASE("terms add up to the value, whatever the options", "[planner][search]") {
  const Maze maze;
  SearchOptions options;
  SECTION("default") {}
  SECTION("as printed in the paper") { options = PaperOptions(); }
  SECTION("chain") { options.expansion = Expansion::kChain; }
  SECTION("several trees") { options.trees = 3; }
  options.exploration_constant = 200.0;
  const SearchResult result = Decide(maze.world.problem, options);
  CheckTermsAddUp(result);
  RewardTerms all;
  for (const SearchAction& action : result.actions) all += action.terms;
  CHECK(all.goals > 0.0);
  CHECK(all.steps < 0.0);
  CHECK(all.guidance < 0.0);
  CHECK(all.smoothness < 0.0);
  CHECK(all.information > 0.0);
  CHECK(all.communication < 0.0);
}

TEST_CASE("terms add up in a tree that was taken over", "[planner][search]") {
  Maze maze;
  SearchProblem& problem = maze.world.problem;
  problem.goals_left = {{5, 7}};  // the near one would end every branch
  SearchOptions options;
  options.iterations = 500;
  options.exploration_constant = 200.0;
  options.tree_reuse = TreeReuse::kPruned;
  std::vector<SearchMemory> memory;
  const SearchResult first = Decide(problem, options, 1, &memory);
  problem.path = {{1, 1}, {2, 1}};
  problem.start = maze.world.At(2, 1);
  const SearchResult second = Decide(problem, options, 1, &memory);
  REQUIRE(second.nodes > Decide(problem, options).nodes);  // some came with the branch
  CheckTermsAddUp(first);
  CheckTermsAddUp(second);
}

TEST_CASE("the detail of the report changes no decision", "[planner][search]") {
  const Maze maze;
  SearchOptions options;
  options.report = SearchDetail::kActions;
  SearchResult plain = Decide(maze.world.problem, options);
  CHECK_FALSE(plain.has_terms);
  CHECK(plain.tree.empty());
  for (const SearchDetail detail : {SearchDetail::kTerms, SearchDetail::kTree}) {
    options.report = detail;
    const SearchResult detailed = Decide(maze.world.problem, options);
    CHECK(detailed.tree.empty() == (detail == SearchDetail::kTerms));
    CHECK(detailed.nodes == plain.nodes);
    REQUIRE(detailed.actions.size() == plain.actions.size());
    for (std::size_t i = 0; i < plain.actions.size(); ++i) {
      CHECK(detailed.actions[i].visits == plain.actions[i].visits);
      CHECK(detailed.actions[i].mean_value == plain.actions[i].mean_value);
    }
  }
}

TEST_CASE("the reported tree is the most visited part of it, whole from the root",
          "[planner][search]") {
  // Moves only, and the goal out of reach: every iteration adds a node.
  const TextWorld world({"##########", "#S......##", "#.......##", "#.......##", "#.......##",
                         "########G#", "##########"},
                        kNoViews);
  SearchOptions options;
  options.report = SearchDetail::kTree;
  const SearchResult result = Decide(world.problem, options);
  REQUIRE(result.nodes > kMaxReportedNodes);
  REQUIRE(result.tree.size() == kMaxReportedNodes);
  CHECK(result.tree[0].parent == -1);
  CHECK(result.tree[0].visits == 2000);
  std::uint32_t of_root = 0;
  for (std::size_t i = 1; i < result.tree.size(); ++i) {
    const ReportedNode& node = result.tree[i];
    REQUIRE(node.parent >= 0);
    REQUIRE(node.parent < static_cast<int>(i));
    CHECK(node.visits <= result.tree[static_cast<std::size_t>(node.parent)].visits);
    if (node.parent == 0) of_root += node.visits;
  }
  std::uint32_t of_actions = 0;
  for (const SearchAction& action : result.actions) of_actions += action.visits;
  CHECK(of_root == of_actions);
  CHECK(Decide(world.problem, options).tree == result.tree);
}

TEST_CASE("every view that was asked about is reported with the most that it was worth",
          "[planner][search]") {
  const Maze maze;
  SearchOptions options;
  options.report = SearchDetail::kTree;
  const SearchResult result = Decide(maze.world.problem, options);
  CHECK(result.views.size() > 8);
  for (const SearchAction& action : result.actions) {
    if (action.kind == CommandKind::kMove) continue;
    const auto is_it = [&](const ReportedView& view) {
      return view.cell == action.target && view.heading_rad == action.heading_rad;
    };
    const auto view = std::find_if(result.views.begin(), result.views.end(), is_it);
    REQUIRE(view != result.views.end());
    CHECK(view->information_gain >= action.information_gain);
  }
}

TEST_CASE("a view that was withheld reports its expected information", "[planner][search]") {
  const TextWorld world({"#####", "#G#S#", "#####"}, {"#####", "#G.S#", "#####"});
  SearchOptions options;
  options.min_information = 10.0;
  const SearchResult result = Decide(world.problem, options);
  CHECK(result.chosen == -1);
  double most = 0.0;
  for (const SearchAction& action : result.actions) most = std::max(most, action.information_gain);
  CHECK(most == Approx(0.6 * std::exp(-0.15)));
}

}  // namespace
}  // namespace conav::planner
