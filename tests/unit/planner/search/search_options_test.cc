#include "planner/search/search_options.h"

#include <catch2/catch.hpp>

#include "common/runtime/config.h"
#include "planner/search/paper_preset.h"

namespace conav::planner {
namespace {

TEST_CASE("the paper's preset holds the printed numbers", "[planner][search]") {
  const SearchOptions options = PaperOptions();
  CHECK(options.iterations == 100);
  CHECK(options.exploration_constant == Approx(std::sqrt(2.0)));
  CHECK(options.discount == 0.99);
  CHECK(options.rollout_depth == 100);
  CHECK(options.expansion == Expansion::kMovesFirst);
  CHECK(LiteralPaperOptions().expansion == Expansion::kChain);
  CHECK(options.offers_sent_views);
  CHECK(options.min_information == 0.0);
  CHECK(options.reward.progress == 0.0);
  CHECK(options.reward.answer == 0.0);
  CHECK(options.reward.goal == 100.0);
  CHECK(options.reward.communication_cost == 10.0);
  CHECK_FALSE(options.optional_pictures);
}

TEST_CASE("the default preset is the one that the experiment chose", "[planner][search]") {
  const SearchOptions options;
  CHECK(options.iterations == 2000);
  CHECK(options.exploration_constant == 5.0);
  CHECK(options.expansion == Expansion::kRandom);
  CHECK(options.tree_reuse == TreeReuse::kNone);
  CHECK_FALSE(options.offers_sent_views);
  CHECK(options.optional_pictures);
  CHECK(options.reward.communication_cost == 0.25);
}

TEST_CASE("a view is worth sending when it informs enough and gains more than it costs",
          "[planner][search]") {
  SearchOptions options;
  options.min_information = 0.5;
  CHECK(IsWorthSending(0.5, 0.01, options));
  CHECK_FALSE(IsWorthSending(0.49, 0.01, options));
  CHECK_FALSE(IsWorthSending(0.5, 0.0, options));
  options.optional_pictures = false;
  CHECK(IsWorthSending(0.5, -10.0, options));
}

TEST_CASE("options are read by name, also those that were written", "[planner][search]") {
  SearchOptions options;
  ReadConfig(YAML::Load("{iterations: 7, tree_reuse: pruned, trees: 4, tree_threads: 2, "
                        "min_information: 0.25, reward: {goal: 30}}"),
             "planner.search", options);
  const YAML::Node document = YAML::Load(DumpConfig("search", options));
  SearchOptions again;
  ReadConfig(document["search"]["ros__parameters"], "search", again);
  for (const SearchOptions& read : {options, again}) {
    CHECK(read.iterations == 7);
    CHECK(read.tree_reuse == TreeReuse::kPruned);
    CHECK(read.trees == 4);
    CHECK(read.tree_threads == 2);
    CHECK(read.min_information == 0.25);
    CHECK(read.reward.goal == 30.0);
  }
}

TEST_CASE("unknown keys and values out of range are rejected by name", "[planner][search]") {
  const auto& [text, key] = GENERATE(table<std::string, std::string>({
      {"{trees: 0}", "trees"},
      {"{discount: 1.5}", "discount"},
      {"{tree_reuse: unchanged}", "tree_reuse"},
      {"{chain_depth: 3}", "chain_depth"},
  }));
  SearchOptions options;
  CHECK_THROWS_WITH(ReadConfig(YAML::Load(text), "planner.search", options), Catch::Contains(key));
}

}  // namespace
}  // namespace conav::planner
