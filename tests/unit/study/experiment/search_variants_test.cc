#include <catch2/catch.hpp>
#include <fstream>

#include "common/runtime/result.h"
#include "study/experiment/search_experiment.h"
#include "support/temporary_folder.h"

namespace conav::planner {
namespace {

using Catch::Matchers::Contains;

std::filesystem::path Write(const test::TemporaryFolder& folder, const std::string& text) {
  const auto file = folder / "variants.yaml";
  std::ofstream(file) << text;
  return file;
}

TEST_CASE("variants are read in their order, as changes of the preset", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  const auto variants =
      ReadSearchVariants(Write(folder,
                               "search_variants:\n  plain: {}\n  few: {iterations: 7, trees: 2}\n"
                               "  printed: {preset: paper, reward: {goal: 30}}\n"
                               "  literal: {preset: paper-literal}\n"));
  REQUIRE(variants.size() == 4);
  CHECK(variants[0].name == "plain");
  CHECK(variants[0].config.options.iterations == SearchOptions().iterations);
  CHECK(variants[1].config.options.iterations == 7);
  CHECK(variants[1].config.options.trees == 2);
  CHECK(variants[2].config.options.iterations == PaperOptions().iterations);
  CHECK(variants[2].config.options.reward.goal == 30.0);
  CHECK(variants[0].config.reliability_prior > 0.0);
  CHECK(variants[2].config.reliability_prior == 0.0);  // the paper has none
  CHECK_FALSE(variants[0].config.blocked_path_guides);
  CHECK(variants[2].config.blocked_path_guides);
  CHECK(variants[3].config.options.expansion == Expansion::kChain);
  CHECK(variants[3].config.reliability_prior == 0.0);
}

TEST_CASE("a variant may say who decides on pictures, and be greedy", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  const auto variants = ReadSearchVariants(
      Write(folder,
            "search_variants:\n"
            "  often: {iterations: 7, communication: {policy: every, every_moves: 3}}\n"
            "  alone: {method: greedy}\n"));
  CHECK(variants[0].communication.policy == "every");
  CHECK(variants[0].communication.every_moves == 3);
  CHECK(variants[0].config.options.iterations == 7);
  CHECK(variants[1].method == MethodKind::kGreedy);
  CHECK(variants[1].communication.policy == "search");
  CHECK_THROWS_WITH(
      ReadSearchVariants(Write(folder, "search_variants: {a: {communication: {policy: loud}}}\n")),
      Contains("variants.yaml: a.communication.policy"));
}

TEST_CASE("bad variants are refused by file, variant and key", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_WITH(ReadSearchVariants(folder / "none.yaml"), Contains("none.yaml"));
  CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, "search: {}\n")),
                    Contains("variants.yaml") && Contains("search_variants"));
  CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, "search_variants: {a: {iterations: 0}}\n")),
                    Contains("variants.yaml: a.iterations") && Contains("out of range"));
  CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, "search_variants: {a: {iteration: 5}}\n")),
                    Contains("iteration"));
}

TEST_CASE("what is no map of variants is refused, a folder too", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  for (const char* text : {"", "hello", "[search_variants]", "search_variants: hello",
                           "search_variants: {}", "search_variants: [a]"}) {
    CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, text)),
                      Contains("variants.yaml: no map search_variants"));
  }
  CHECK_THROWS_WITH(ReadSearchVariants(folder.path()), Contains("cannot read: Is a directory"));
  CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, "search_variants: {a: hello}")),
                    Contains("variants.yaml: a: expected a mapping"));
}

TEST_CASE("the variants that come with conav can be read", "[planner][experiment]") {
  CHECK(ReadSearchVariants(CONAV_BIN_DIR "/../share/conav/config/search_variants.yaml").size() > 5);
}

}  // namespace
}  // namespace conav::planner
