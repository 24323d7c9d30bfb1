#include "study/experiment/scenarios.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace conav::planner {
namespace {

std::vector<SearchVariant> Methods() {
  std::vector<SearchVariant> methods;
  for (const char* name : {"greedy", "never", "random", "ig-mcts", "ig-mcts-glpf"}) {
    methods.emplace_back().name = name;
  }
  methods[0].method = MethodKind::kGreedy;
  methods[1].communication.policy = "never";
  methods[2].communication.policy = "random";
  return methods;
}

/// Moves and pictures of each method of Methods(), alike in three mazes but for a move.
struct Table {
  std::vector<int> moves, pictures;
  int never_goals = 4;
};

ScenarioResult ResultOf(const Table& table) {
  ScenarioResult result;
  result.experiment.scenario.name = "s";
  result.experiment.variants = Methods();
  result.experiment.operators = {"careful"};
  result.experiment.seeds = 3;
  for (std::size_t method = 0; method < table.moves.size(); ++method) {
    for (int maze = 0; maze < 3; ++maze) {
      EpisodeResult episode{.goals_reached = 4, .goals = 4, .action_limit = 600};
      if (method == 1) episode.goals_reached = table.never_goals;
      episode.all_goals = episode.goals_reached == 4;
      episode.moves = table.moves[method] + maze;
      episode.snapshots = table.pictures[method];
      result.episodes.push_back({method, 0, static_cast<std::uint64_t>(maze + 1), episode});
    }
  }
  return result;
}

TEST_CASE("the person matters where pictures save steps that no rule saves with fewer",
          "[study][scenarios]") {
  struct Row {
    const char* name;
    Table table;
    bool person, perception;
    std::string reason;
  };
  for (const Row& row : std::vector<Row>{
           {"short", {{60, 60, 60, 40, 50}, {0, 0, 5, 4, 4}}, true, true, ""},
           {"greedy ties", {{40, 60, 60, 40, 40}, {0, 0, 5, 4, 4}}, false, false, "greedy"},
           {"never ties", {{60, 40, 60, 40, 40}, {0, 0, 5, 4, 6}}, false, true, "never-send"},
           {"only all goals", {{60, 40, 60, 40, 40}, {0, 0, 5, 4, 4}, 2}, true, false, ""},
           {"hardly longer", {{160, 160, 160, 100, 99}, {0, 0, 5, 4, 6}}, true, true, ""},
           {"longer", {{160, 160, 160, 100, 95}, {0, 0, 5, 4, 6}}, true, false, ""},
           {"a rule does it", {{60, 60, 40, 40, 40}, {0, 0, 3, 4, 4}}, false, false, "random"},
           {"a rule with more pictures",
            {{60, 60, 40, 40, 40}, {0, 0, 5, 4, 4}},
            true,
            false,
            ""}}) {
    CAPTURE(row.name);
    const ScenarioResult result = ResultOf(row.table);
    const ScenarioVerdict verdict = Judge(result, 0);
    CHECK(verdict.person_matters == row.person);
    CHECK(verdict.perception_matters == row.perception);
    CHECK(verdict.reason == row.reason);
    const auto json = ScenariosJson({result});
    CHECK(json["person_matters"].size() == (row.person ? 1U : 0U));
    CHECK(json["scenarios"]["s"]["ig-mcts"]["bytes_mean"] == 4 * 180.0 * 1024.0);
  }
}

TEST_CASE("an episode without all goals takes the steps of its limit", "[study][scenarios]") {
  const SearchVariant drives;
  SearchVariant steered;
  steered.steers = true;
  const EpisodeResult stuck{.moves = 3, .action_limit = 100};
  const EpisodeResult arrived{.all_goals = true, .moves = 10, .action_limit = 100};
  CHECK(StepsOf(drives, stuck) == EstimatedLowLevelSteps(100, 0.0));
  CHECK(StepsOf(drives, arrived) == EstimatedLowLevelSteps(10, 0.0));
  CHECK(StepsOf(steered, arrived) == Approx(100.0));  // 2 m at 0.8 m/s, in steps of 0.25 s
}

/// The file that comes with conav, which is next to the programs and not to the tests.
std::vector<launcher::Scenario> Shipped() {
  return launcher::ReadScenarios(CONAV_SOURCE_DIR "/deploy/config/scenarios.yaml");
}

TEST_CASE("scenarios and methods that come with conav can be played", "[study][scenarios]") {
  const auto scenarios = Shipped();
  const auto methods =
      ReadSearchVariants(CONAV_SOURCE_DIR "/deploy/config/scenarios.yaml", "methods");
  CHECK(methods.size() >= 10);
  for (const launcher::Scenario& scenario : scenarios) {
    CAPTURE(scenario.name);
    CHECK_FALSE(scenario.about.empty());
    SearchExperiment experiment;
    experiment.scenario = scenario;
    experiment.operators = {"careful"};
    experiment.seeds = 1;
    experiment.first_seed = 7;
    experiment.variants = {FindVariant(methods, "oracle", "")};
    const auto episodes = RunSearchExperiment(experiment, std::make_shared<FakePerceptionModel>());
    REQUIRE(episodes);
    CHECK(episodes->front().result.all_goals);
  }
}

TEST_CASE("an episode ends when a robot can only ask", "[study][scenarios]") {
  const auto scenarios = Shipped();
  SearchExperiment experiment;
  experiment.scenario = *std::ranges::find(scenarios, "search", &launcher::Scenario::name);
  experiment.operators = {"careful"};
  experiment.seeds = 1;
  experiment.variants = {{.name = "instruction", .method = MethodKind::kInstruction}};
  const auto episodes = RunSearchExperiment(experiment, std::make_shared<FakePerceptionModel>());
  REQUIRE(episodes);
  CHECK(episodes->front().result.moves == 0);
  CHECK_FALSE(episodes->front().result.all_goals);
}

TEST_CASE("a person finds goals in pictures, robots wait for each other, doors close",
          "[study][scenarios]") {
  const auto scenarios = Shipped();
  for (const char* name : {"search", "team", "closing-doors", "seen-goals", "no-map"}) {
    CAPTURE(name);
    SearchExperiment experiment;
    experiment.scenario = *std::ranges::find(scenarios, name, &launcher::Scenario::name);
    experiment.operators = {"careful"};
    experiment.seeds = 1;
    experiment.first_seed = 11;
    experiment.variants.emplace_back();
    const auto episodes = RunSearchExperiment(experiment, std::make_shared<FakePerceptionModel>());
    REQUIRE(episodes);
    const EpisodeResult& result = episodes->front().result;
    CHECK(result.all_goals);
    CHECK(result.goals == 4 * experiment.scenario.robots);
    CHECK(result.snapshots > 0);
  }
}

}  // namespace
}  // namespace conav::planner
