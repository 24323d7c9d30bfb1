#include "study/experiment/search_experiment.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/random.h"
#include "nhpm/model/glpf.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace conav::planner {
namespace {

SearchExperiment SmallExperiment() {
  SearchExperiment experiment;
  experiment.variants = {{"few", {.options = {.iterations = 200}}},
                         {"printed", {.options = PaperOptions()}}};
  experiment.operators = {"careful", "silent"};
  experiment.seeds = 2;
  experiment.first_seed = 11;
  return experiment;
}

std::vector<ExperimentEpisode> Play(const SearchExperiment& experiment) {
  return RunSearchExperiment(experiment, std::make_shared<nhpm::Glpf>()).value();
}

TEST_CASE("every variant plays with every operator in the same mazes, on any number of threads",
          "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  std::size_t reported = 0;
  const auto episodes = RunSearchExperiment(experiment, std::make_shared<nhpm::Glpf>(),
                                            [&](const study::PieceProgress& now) {
                                              CHECK(now.done == ++reported);
                                              CHECK(now.of == 8);
                                            });
  REQUIRE(episodes.has_value());
  REQUIRE(episodes->size() == 8);
  CHECK(reported == 8);
  CHECK((*episodes)[5].variant == 1);
  CHECK((*episodes)[5].person == 0);
  CHECK((*episodes)[5].seed == 12);
  CHECK((*episodes)[0].result.optimal_moves == (*episodes)[4].result.optimal_moves);
  CHECK((*episodes)[2].result.guidance == 0);  // silent
  SearchExperiment threaded = experiment;
  threaded.threads = 3;
  CHECK(ExperimentCsv(experiment, *episodes) == ExperimentCsv(threaded, Play(threaded)));
}

ExperimentEpisode EpisodeOf(int goals_reached, int moves, int snapshots,
                            std::vector<double> decision_ms = {}) {
  ExperimentEpisode episode;
  episode.result = {.all_goals = goals_reached == 4,
                    .goals_reached = goals_reached,
                    .goals = 4,
                    .moves = moves,
                    .optimal_moves = 10,
                    .snapshots = snapshots,
                    .decision_ms = std::move(decision_ms)};
  return episode;
}

TEST_CASE("a summary counts and averages its episodes", "[planner][experiment]") {
  std::vector<ExperimentEpisode> episodes{EpisodeOf(4, 12, 3, {1.0, 9.0}),
                                          EpisodeOf(1, 2, 9, {2.0}), EpisodeOf(0, 0, 0)};
  episodes[2].person = 1;
  const auto summaries = Summarize(SmallExperiment(), episodes);
  REQUIRE(summaries.size() == 2);
  CHECK(summaries[0].episodes == 2);
  CHECK(summaries[0].all_goals == 1);
  CHECK(summaries[0].goals_share.mean == Approx(0.625));
  CHECK(summaries[0].moves.mean == Approx(7.0));
  CHECK(summaries[0].moves_ratio.value().mean == Approx(1.2));  // of the episode that got there
  CHECK(summaries[0].snapshots.mean == Approx(6.0));
  CHECK(summaries[0].decision_ms_p50 == 2.0);
}

TEST_CASE("the frontier has a point for each variant and operator", "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  const std::string plot = FrontierPlot(experiment, Summarize(experiment, Play(experiment)));
  for (const char* text : {">few<", ">printed<", "careful", "silent", "low-level steps"}) {
    CHECK_THAT(plot, Catch::Contains(text));
  }
  CHECK(test::CountOf(plot, "<circle") == 2 * 4 + 2);  // two panels, and the legend
}

TEST_CASE("the bars are those of the default with the careful operator", "[planner][experiment]") {
  SearchExperiment experiment = SmallExperiment();
  experiment.variants.resize(1);
  experiment.variants[0].name = "default";
  experiment.operators = {"careful"};
  const std::vector<ExperimentEpisode> episodes(2, EpisodeOf(4, 12, 15));
  CHECK_THAT(
      ExperimentTable(experiment, Summarize(experiment, episodes)),
      Catch::Contains("goals met") && Catch::Contains("1.25 met") && Catch::Contains("14 MISSED"));
  experiment.variants[0].name = "another";
  CHECK_THAT(ExperimentTable(experiment, Summarize(experiment, episodes)),
             !Catch::Contains("bars of"));
}

TEST_CASE("where nobody arrived there is no ratio to the optimal tour", "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  const std::vector<ExperimentEpisode> episodes(2, EpisodeOf(1, 30, 0));
  const auto summaries = Summarize(experiment, episodes);
  const std::string table = ExperimentTable(experiment, summaries);
  CHECK_THAT(table, Catch::Contains("   0/2     30.0 [30.0, 30.0]") && Catch::Contains("  -  "));
  const auto row = ExperimentJson(experiment, summaries)["rows"][0];
  CHECK(row["moves_ratio"].is_null());
  CHECK(row["moves"]["mean"] == 30.0);
}

TEST_CASE("an operator who is wrong on purpose gets few pictures, and the robot reaches its goals",
          "[planner][experiment]") {
  SearchExperiment experiment;
  experiment.variants = {{"weighed", {}}, {"believed", {.reliability_prior = 0.0}}};
  experiment.operators = {"wrong"};
  experiment.seeds = 5;
  const auto summaries = Summarize(experiment, Play(experiment));
  CHECK(summaries[0].all_goals == 5);
  CHECK(summaries[0].snapshots.mean < 0.5 * summaries[1].snapshots.mean);
}

TEST_CASE("the bootstrap interval is about two standard errors wide each way",
          "[planner][experiment]") {
  Random random(7);
  std::vector<double> values;
  double mean = 0.0;
  for (int i = 0; i < 400; ++i) {
    values.push_back(random.Unit());
    mean += values.back() / 400.0;
  }
  const double error = std::sqrt(1.0 / 12.0 / 400.0);
  const Interval interval = BootstrapMean(values, 1);
  CHECK(interval.low == Approx(mean - 1.96 * error).margin(0.2 * error));
  CHECK(interval.high == Approx(mean + 1.96 * error).margin(0.2 * error));
  CHECK(BootstrapMean(values, 1).low == interval.low);
  const Interval equal = BootstrapMean(std::vector<double>(10, 3.0), 1);
  CHECK(equal.low == 3.0);
  CHECK(equal.high == 3.0);
  CHECK(BootstrapMean({}, 3).high == 0.0);
}

using Catch::Matchers::Contains;

std::filesystem::path Write(const test::TemporaryFolder& folder, const std::string& text) {
  const auto file = folder / "variants.yaml";
  std::ofstream(file) << text;
  return file;
}

TEST_CASE("variants change the search that they are given, unless they name a preset",
          "[planner][experiment]") {
  const test::TemporaryFolder folder;
  const auto file = Write(folder,
                          "search_variants:\n  plain: {}\n  few: {iterations: 7}\n"
                          "  other: {preset: default, iterations: 8}\n");
  const auto variants = ReadSearchVariants(file, "search_variants", SearchFrom("paper-2000"));
  CHECK(variants[0].config.options.iterations == 2000);
  CHECK(variants[0].config.reliability_prior == 0.0);
  CHECK(variants[1].config.options.iterations == 7);
  CHECK(variants[1].config.reliability_prior == 0.0);
  CHECK(variants[2].config.options.iterations == 8);
  CHECK(variants[2].config.reliability_prior > 0.0);
}

TEST_CASE("variants are read in their order, as changes of the preset", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  const auto variants =
      ReadSearchVariants(Write(folder,
                               "search_variants:\n  plain: {}\n  few: {iterations: 7, trees: 2}\n"
                               "  printed: {preset: paper, reward: {goal: 30}}\n"
                               "  literal: {preset: paper-literal}\n"
                               "  often: {communication: {policy: every, every_moves: 3}}\n"
                               "  alone: {method: greedy}\n"
                               "  other: {model: glpf, glpf: {beta: 7}}\n"
                               "  known: {weights: one-population.nhpm}\n"));
  REQUIRE(variants.size() == 8);
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
  CHECK(variants[4].communication.policy == "every");
  CHECK(variants[4].communication.every_moves == 3);
  CHECK(variants[5].method == MethodKind::kGreedy);
  CHECK(variants[5].communication.policy == "search");
  CHECK(variants[6].glpf.beta == 7.0);
  CHECK(variants[7].weights == "one-population.nhpm");
}

TEST_CASE("a variant's own model predicts, and weights that are not there are named",
          "[planner][experiment]") {
  SearchExperiment experiment;
  experiment.operators = {"careful"};
  experiment.seeds = 1;
  experiment.first_seed = 3;
  experiment.variants.resize(2);
  experiment.variants[0].model = experiment.variants[1].model = PerceptionModelKind::kGlpf;
  experiment.variants[1].glpf = {.beta = 0.0, .rho = 0.5, .lambda = 0.5};  // edits everywhere
  const auto nobody = std::make_shared<FakePerceptionModel>();
  const auto episodes = RunSearchExperiment(experiment, nobody);
  REQUIRE(episodes);
  CHECK(episodes->at(0).result.snapshots != episodes->at(1).result.snapshots);
  experiment.variants[1] = {.weights = "none.nhpm"};
  CHECK_THROWS_WITH(RunSearchExperiment(experiment, nobody), Contains("none.nhpm"));
}

TEST_CASE("bad variants are rejected by file, variant and key", "[planner][experiment]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_WITH(ReadSearchVariants(folder / "none.yaml"), Contains("none.yaml"));
  CHECK_THROWS_WITH(ReadSearchVariants(folder.path()), Contains("cannot read: Is a directory"));
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {"", "no map search_variants"},
           {"hello", "no map search_variants"},
           {"search_variants: hello", "no map search_variants"},
           {"search_variants: {}", "no map search_variants"},
           {"search_variants: {a: hello}", "a: expected a mapping"},
           {"search_variants: {a: {iterations: 0}}", "a.iterations"},
           {"search_variants: {a: {communication: {policy: loud}}}", "a.communication.policy"},
           {"search_variants: {a: {model: glpf, weights: w.nhpm}}", "a.weights"},
           {"search_variants: {a: {iteration: 5}}", "iteration"}}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(ReadSearchVariants(Write(folder, text)),
                      Contains("variants.yaml: ") && Contains(named));
  }
}

}  // namespace
}  // namespace conav::planner
