#include <algorithm>
#include <catch2/catch.hpp>

#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

const SearchAction& Chosen(const SearchResult& result) {
  REQUIRE(result.chosen >= 0);
  return result.actions.at(static_cast<std::size_t>(result.chosen));
}

TEST_CASE("the robot steps onto a goal next to it", "[planner][search]") {
  const TextWorld world({"#####", "#...#", "#GS.#", "#...#", "#####"});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SearchResult result = Decide(world.problem, {}, seed);
    CHECK(Chosen(result).kind == CommandKind::kMove);
    CHECK(Chosen(result).target == Cell{2, 1});
    CHECK(result.expected_path == std::vector<Cell>{{2, 1}});
  }
}

TEST_CASE("a budget of one tries the first action", "[planner][search]") {
  const TextWorld world({"#####", "#S.G#", "#.###", "#####"}, kNoViews);
  const SearchResult result = Decide(world.problem, ByHand(1));
  CHECK(result.iterations == 1);
  CHECK(Chosen(result).target == Cell{1, 2});
  CHECK(Chosen(result).visits == 1);
  CHECK(result.actions[1].visits == 0);
}

TEST_CASE("the value of a corridor approaches what its steps are worth", "[planner][search]") {
  const TextWorld world({"#####", "#S.G#", "#####"}, kNoViews);  // -1, then 100
  const SearchResult searched = Decide(world.problem, ByHand(2000));
  CHECK(searched.actions[0].mean_value == Approx(49.0).margin(1.0));
  CHECK(searched.expected_path == std::vector<Cell>{{1, 2}, {1, 3}});
}

TEST_CASE("an action into an unknown cell says how feasible it is", "[planner][search]") {
  const TextWorld world({"######", "#S?G##", "######"}, kNoViews);
  CHECK(Decide(world.problem, ByHand(1)).actions[0].feasibility == 0.5);
}

TEST_CASE("pictures that cost too much are paid for in no branch, of one tree or of several",
          "[planner][search]") {
  const TextWorld world({"######", "#S...#", "#...G#", "######"},
                        {"######", "#S#..#", "#...G#", "######"});
  SearchOptions options;
  options.trees = GENERATE(1, 3);
  const auto tries_pictures = [&](double cost) {
    options.reward.communication_cost = cost;
    const auto is_tried = [](const SearchAction& action) {
      return action.kind == CommandKind::kTransmitView && action.visits > 0;
    };
    return std::ranges::any_of(Decide(world.problem, options).actions, is_tried);
  };
  CHECK(tries_pictures(0.0));
  CHECK_FALSE(tries_pictures(1000.0));
  const SearchResult result = Decide(world.problem, options);
  REQUIRE(result.has_terms);
  REQUIRE(Chosen(result).kind == CommandKind::kMove);
  for (const SearchAction& action : result.actions) {
    CHECK(action.terms.Sum() == Approx(action.mean_value).margin(1e-9));
    CHECK(action.terms.communication == 0.0);
  }
  options.optional_pictures = false;  // in the paper every branch pays
  CHECK(tries_pictures(1000.0));
  CHECK(Chosen(Decide(world.problem, options)).terms.communication < 0.0);
}

TEST_CASE("a robot that can do nothing but send pictures not worth it does nothing",
          "[planner][search]") {
  const TextWorld known({"#####", "#G#S#", "#####"});  // views promise nothing
  CHECK(Decide(known.problem).chosen == -1);
  CHECK(Decide(known.problem).iterations == 0);
  CHECK(Decide(known.problem).actions.size() == 8);
  CHECK(Decide(known.problem, PaperOptions()).chosen >= 0);
  TextWorld world({"#####", "#G#S#", "#####"}, {"#####", "#G.S#", "#####"});
  SearchOptions options;
  options.reward.view_turn = 0.0;
  CHECK(Decide(world.problem, options).chosen >= 0);
  options.reward.communication_cost = 1000.0;
  CHECK(Decide(world.problem, options).chosen == -1);
  // A view that was sent is not offered again, unless the paper is to be followed.
  world.problem.sent_views = {{{1, 3}, world.graph.HeadingsAt(0)[4]}};
  CHECK(Decide(world.problem).actions.size() == 7);
  CHECK(Decide(world.problem, PaperOptions()).actions.size() == 8);
}

TEST_CASE("nothing is decided when no goal is left or nothing can be done", "[planner][search]") {
  TextWorld done({"####", "#SG#", "####"});
  done.problem.goals_left.clear();
  CHECK(Decide(done.problem).chosen == -1);
  done.problem.goals_left = {{1, 1}};
  CHECK(Decide(done.problem).chosen == -1);
  const TextWorld boxed({"#####", "#S#G#", "#####"}, kNoViews);
  const SearchResult result = Decide(boxed.problem);
  CHECK(result.chosen == -1);
  CHECK(result.actions.empty());
}

TEST_CASE("a chain adds several nodes in one iteration, up to a limit", "[planner][search]") {
  const TextWorld world({"################", "#S............G#", "################"}, kNoViews);
  SearchOptions options = ByHand(1);
  options.expansion = Expansion::kChain;
  CHECK(Decide(world.problem, options).nodes == 1 + kMostOfChain);
  options.expansion = GENERATE(Expansion::kMovesFirst, Expansion::kRandom);
  CHECK(Decide(world.problem, options).nodes == 1 + 1);
}

}  // namespace
}  // namespace conav::planner
