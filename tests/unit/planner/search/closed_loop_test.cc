#include "closed_loop.h"

#include <catch2/catch.hpp>

#include "planner/search/fake_perception_model.h"

namespace conav::planner::closed_loop {
namespace {

TEST_CASE("the default search reaches all goals in every maze", "[planner][search][closed_loop]") {
  FakePerceptionModel model;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    INFO("seed " << seed);
    const EpisodeResult result = RunEpisode(MakeWorld(seed), {}, model, seed);
    CHECK(result.all_goals);
    CHECK(result.messages < 60);
    CHECK(result.perception_calls < 100U * static_cast<unsigned>(result.decisions));
  }
}

TEST_CASE("messages mend the operator's map", "[planner][search][closed_loop]") {
  FakePerceptionModel model;
  int edits = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    edits += RunEpisode(MakeWorld(seed), {}, model, seed).edits;
  }
  CHECK(edits >= 12);
}

TEST_CASE("the printed numbers do not get there", "[planner][search][closed_loop]") {
  FakePerceptionModel model;
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    reached += RunEpisode(MakeWorld(seed), PaperOptions(), model, seed).all_goals ? 1 : 0;
  }
  CHECK(reached < 3);
}

TEST_CASE("the same seed gives the same episode", "[planner][search][closed_loop]") {
  FakePerceptionModel model;
  const World world = MakeWorld(5);
  const EpisodeResult first = RunEpisode(world, {}, model, 9);
  const EpisodeResult second = RunEpisode(world, {}, model, 9);
  CHECK(first.trajectory == second.trajectory);
  CHECK(first.messages == second.messages);
}

}  // namespace
}  // namespace conav::planner::closed_loop
