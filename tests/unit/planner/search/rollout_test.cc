#include <catch2/catch.hpp>

#include "planner/search/ig_mcts.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// Everything a rollout needs around a world.
struct RolloutFixture {
  RolloutFixture(const TextWorld& text_world, SearchOptions search_options, std::uint64_t seed = 1)
      : options(search_options),
        path(text_world.problem),
        offered(text_world.problem),
        information(text_world.problem, offered, model),
        random(seed),
        rollout(options, path, offered, information, random) {}

  double Run() { return rollout.Run(path).value(); }

  SearchOptions options;
  FakePerceptionModel model;
  PathState path;
  OfferedActions offered;
  ViewInformation information;
  Random random;
  Rollout rollout;
};

TEST_CASE("a view that costs more than it gains ends a rollout without being sent",
          "[planner][search]") {
  // Nowhere to go: the first action is a view.
  const TextWorld world({"#####", "#S#G#", "#####"}, {"#####", "##.G#", "#####"});
  SearchOptions options;
  options.reward.communication_cost = 1000.0;
  RolloutFixture dear(world, options);
  CHECK(dear.Run() == 0.0);
  CHECK(dear.rollout.Terms(dear.path) == RewardTerms{});
  options.optional_pictures = false;
  RolloutFixture owed(world, options);
  CHECK(owed.Run() < -900.0);
  CHECK(owed.rollout.Terms(owed.path).communication < -900.0);
}

TEST_CASE("a communication's information counts, discounted by the steps before it",
          "[planner][search]") {
  // The only place to communicate from lies one step away: both views of the start were sent.
  TextWorld world({"####", "#S.#", "####"}, {"####", "#S##", "####"}, {.headings = 1});
  world.problem.sent_views = {{{1, 1}, 0.0}};
  // Step 0 moves (-1); step 1 sends (0.9 for the wall that the robot stands in, less 10) or moves.
  int sent_at_once = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RolloutFixture fixture(world, ByHand(1), seed);
    const double value = fixture.Run();
    const bool at_once = value == Approx(-1.0 + 0.5 * (0.9 - 10.0)).margin(1e-6);
    sent_at_once += at_once ? 1 : 0;
    const RewardTerms terms = fixture.rollout.Terms(fixture.path);
    CHECK(terms.Sum() == Approx(value));
    if (at_once) CHECK(terms.communication == Approx(0.5 * -10.0));
  }
  CHECK(sent_at_once > 30);
  CHECK(sent_at_once < 70);
}

TEST_CASE("a rollout ends at a goal, when it communicates, or nothing is left or offered",
          "[planner][search]") {
  const TextWorld near({"####", "#SG#", "####"}, kNoViews);
  RolloutFixture arrives(near, ByHand(1));
  CHECK(arrives.Run() == Approx(100.0));
  CHECK(arrives.path.steps() == 0);
  TextWorld boxed({"###", "#S#", "###"});
  boxed.problem.guidance = {{1, 1}};
  CHECK(RolloutFixture(boxed, ByHand(1)).Run() == Approx(-10.0));
  TextWorld world({"#####", "#S..#", "#####"}, kNoViews);
  SearchOptions options = ByHand(1);
  options.rollout_depth = 2;
  // To the middle, -1; then either on, -1, or back, -1 and -1 for the second visit.
  const double value = RolloutFixture(world, options).Run();
  CHECK((value == Approx(-1.0 - 0.5) || value == Approx(-1.0 - 0.5 * 2.0)));

  const TextWorld closed({"###", "#S#", "###"}, kNoViews);
  CHECK(RolloutFixture(closed, options).Run() == 0.0);
}

TEST_CASE("an unknown cell is drawn once per rollout and forgotten, a blocked robot stays",
          "[planner][search]") {
  const TextWorld world({"####", "#S?#", "####"}, kNoViews);
  SearchOptions options = ByHand(1);
  options.rollout_depth = 3;
  options.discount = 1.0;
  // Blocked: stays three times, -1-1, -1-2, -1-3. Free: there -1, back -1-1, there -1-1.
  int blocked = 0;
  RolloutFixture fixture(world, options);
  for (int i = 0; i < 200; ++i) {
    const double value = fixture.Run();
    REQUIRE((value == Approx(-9.0) || value == Approx(-5.0)));
    blocked += value == Approx(-9.0) ? 1 : 0;
  }
  CHECK(blocked > 70);
  CHECK(blocked < 130);
}

TEST_CASE("a cell that the branch has passed is free", "[planner][search]") {
  const TextWorld world({"####", "#S?#", "####"}, kNoViews);
  SearchOptions options = ByHand(1);
  options.rollout_depth = 2;
  options.discount = 1.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RolloutFixture fixture(world, options, seed);
    fixture.path.Go(world.EdgeBetween({1, 1}, {1, 2}));
    CHECK(fixture.Run() == Approx(-4.0));  // back and there again, always
  }
}

}  // namespace
}  // namespace conav::planner
