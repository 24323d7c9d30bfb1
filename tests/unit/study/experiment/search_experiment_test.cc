#include "study/experiment/search_experiment.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "nhpm/model/glpf.h"
#include "study/experiment/experiment_report.h"

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

TEST_CASE("every variant plays with every operator in the same mazes", "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  std::size_t told = 0;
  const auto episodes = RunSearchExperiment(experiment, std::make_shared<nhpm::Glpf>(),
                                            [&](std::size_t done, std::size_t of) {
                                              CHECK(done == ++told);
                                              CHECK(of == 8);
                                            });
  REQUIRE(episodes.has_value());
  REQUIRE(episodes->size() == 8);
  CHECK(told == 8);
  CHECK((*episodes)[5].variant == 1);
  CHECK((*episodes)[5].person == 0);
  CHECK((*episodes)[5].seed == 12);
  CHECK((*episodes)[0].result.optimal_moves == (*episodes)[4].result.optimal_moves);
  CHECK((*episodes)[2].result.guidance == 0);  // silent
}

TEST_CASE("the number of threads changes no episode", "[planner][experiment]") {
  SearchExperiment experiment = SmallExperiment();
  const auto one = Play(experiment);
  experiment.threads = 3;
  const auto three = Play(experiment);
  CHECK(ExperimentCsv(experiment, one) == ExperimentCsv(experiment, three));
}

TEST_CASE("a summary counts and averages its episodes", "[planner][experiment]") {
  std::vector<ExperimentEpisode> episodes(3);
  episodes[0].result = {.all_goals = true,
                        .goals_reached = 4,
                        .goals = 4,
                        .moves = 12,
                        .optimal_moves = 10,
                        .pictures = 3,
                        .decision_ms = {1.0, 9.0}};
  episodes[1].result = {.all_goals = false,
                        .goals_reached = 1,
                        .goals = 4,
                        .moves = 2,
                        .optimal_moves = 10,
                        .pictures = 9,
                        .decision_ms = {2.0}};
  episodes[2].person = 1;
  episodes[2].result = {.goals = 4, .optimal_moves = 10};
  const auto summaries = Summarize(episodes);
  REQUIRE(summaries.size() == 2);
  CHECK(summaries[0].episodes == 2);
  CHECK(summaries[0].all_goals == 1);
  CHECK(summaries[0].goals_share.mean == Approx(0.625));
  CHECK(summaries[0].moves.mean == Approx(7.0));
  CHECK(summaries[0].moves_ratio.value().mean == Approx(1.2));  // of the episode that got there
  CHECK(summaries[0].pictures.mean == Approx(6.0));
  CHECK(summaries[0].decision_ms_p50 == 2.0);
}

TEST_CASE("the report names variants, operators and where the figures come from",
          "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  const auto summaries = Summarize(Play(experiment));
  const std::string table = ExperimentTable(experiment, summaries);
  CHECK(table.find("SIMULATED") != std::string::npos);
  CHECK(table.find("printed") != std::string::npos);
  const auto json = ExperimentJson(experiment, summaries);
  CHECK(json["operators"] == "simulated");
  REQUIRE(json["rows"].size() == 4);
  CHECK(json["rows"][1]["operator"] == "silent");
  CHECK(json["rows"][0]["moves"]["low"] <= json["rows"][0]["moves"]["mean"]);
}

TEST_CASE("the bars are those of the default with the careful operator", "[planner][experiment]") {
  SearchExperiment experiment = SmallExperiment();
  experiment.variants.resize(1);
  experiment.variants[0].name = "default";
  experiment.operators = {"careful"};
  std::vector<ExperimentEpisode> episodes(2);
  for (ExperimentEpisode& episode : episodes) {
    episode.result = {.all_goals = true,
                      .goals_reached = 4,
                      .goals = 4,
                      .moves = 12,
                      .optimal_moves = 10,
                      .pictures = 15};
  }
  CHECK_THAT(ExperimentTable(experiment, Summarize(episodes)),
             Catch::Contains("all goals met; moves / optimal tour at most 1.25 met; pictures at "
                             "most 14 MISSED"));
  experiment.variants[0].name = "another";
  CHECK_THAT(ExperimentTable(experiment, Summarize(episodes)), !Catch::Contains("bars of"));
}

TEST_CASE("where nobody arrived there is no ratio to the optimal tour", "[planner][experiment]") {
  const SearchExperiment experiment = SmallExperiment();
  std::vector<ExperimentEpisode> episodes(2);
  for (ExperimentEpisode& episode : episodes) {
    episode.result = {.goals_reached = 1, .goals = 4, .moves = 30, .optimal_moves = 10};
  }
  const auto summaries = Summarize(episodes);
  const std::string table = ExperimentTable(experiment, summaries);
  CHECK_THAT(table,
             Catch::Contains("   0/2     30.0 [30.0, 30.0]     -                     0.0 ["));
  const auto row = ExperimentJson(experiment, summaries)["rows"][0];
  CHECK(row["moves_ratio"].is_null());
  CHECK(row["moves"]["mean"] == 30.0);
}

TEST_CASE("who is wrong on purpose gets few pictures, and the robot reaches its goals",
          "[planner][experiment]") {
  SearchExperiment experiment;
  experiment.variants = {{"weighed", {}}, {"believed", {.reliability_prior = 0.0}}};
  experiment.operators = {"wrong"};
  experiment.seeds = 5;
  const auto summaries = Summarize(Play(experiment));
  CHECK(summaries[0].all_goals == 5);
  CHECK(summaries[0].pictures.mean < 0.5 * summaries[1].pictures.mean);
}

TEST_CASE("an unknown preset is an error", "[planner][experiment]") {
  SearchExperiment experiment = SmallExperiment();
  experiment.preset = "nowhere";
  const auto episodes = RunSearchExperiment(experiment, std::make_shared<nhpm::Glpf>());
  REQUIRE_FALSE(episodes.has_value());
  CHECK(episodes.error().code == ErrorCode::kNotFound);
}

}  // namespace
}  // namespace conav::planner
