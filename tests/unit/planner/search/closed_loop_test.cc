#include "closed_loop.h"

#include <fmt/format.h>

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

SearchOptions Variant(int iterations, Expansion expansion, bool additions) {
  SearchOptions options;
  options.iterations = iterations;
  options.expansion = expansion;
  if (additions) return options;
  options.min_information = 0.0;
  options.reward.progress = 0.0;
  return options;
}

/// Prints what the defaults were chosen by: planner_search_test "[experiment]"
TEST_CASE("episodes by budget, expansion and our additions to the reward", "[.experiment]") {
  constexpr int kEpisodes = 20;
  fmt::print("iterations expansion additions  goals  moves  messages  edits\n");
  for (const bool additions : {false, true}) {
    for (const Expansion expansion : {Expansion::kSingle, Expansion::kChain}) {
      for (const int iterations : {500, 1000, 2000}) {
        int goals = 0, moves = 0, messages = 0, edits = 0;
        for (std::uint64_t seed = 1; seed <= kEpisodes; ++seed) {
          FakePerceptionModel model;
          const EpisodeResult result =
              RunEpisode(MakeWorld(seed), Variant(iterations, expansion, additions), model, seed);
          goals += result.all_goals ? 1 : 0;
          moves += result.moves;
          messages += result.messages;
          edits += result.edits;
        }
        const auto mean = [](int sum) { return static_cast<double>(sum) / kEpisodes; };
        fmt::print("{:10} {:>9} {:>9}  {:3} %  {:5.1f}  {:8.1f}  {:5.1f}\n", iterations,
                   expansion == Expansion::kSingle ? "single" : "chain", additions ? "yes" : "no",
                   100 * goals / kEpisodes, mean(moves), mean(messages), mean(edits));
      }
    }
  }
}

}  // namespace
}  // namespace conav::planner::closed_loop
