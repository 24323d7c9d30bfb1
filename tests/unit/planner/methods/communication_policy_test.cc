#include <catch2/catch.hpp>

#include "planner/methods/ig_mcts_method.h"

using namespace conav;
using namespace conav::planner;

namespace {

/// A robot in a corridor with a path to its end.
Situation OnTheWay() {
  Situation situation;
  situation.state.cell = {1, 2};
  situation.state.path = {{1, 1}, {1, 2}};
  situation.map.cells = OccupancyGrid(3, 6, Occupancy::kUnknown);
  situation.guidance = Guidance{.path = {{1, 1}, {1, 2}, {1, 3}, {1, 4}}};
  situation.guided_before = true;
  return situation;
}

std::unique_ptr<CommunicationPolicy> Make(const CommunicationConfig& config,
                                          std::uint64_t seed = 1) {
  return MakeCommunicationPolicy(config, seed);
}

int Wanted(CommunicationPolicy& policy, int decisions) {
  int wanted = 0;
  for (int i = 0; i < decisions; ++i) wanted += policy.Wants({}) ? 1 : 0;
  return wanted;
}

}  // namespace

TEST_CASE("guidance fails at a known wall ahead, beside the path, at its end and when it expired",
          "[planner][communication]") {
  Situation situation = OnTheWay();
  CHECK_FALSE(GuidanceFails(situation));
  situation.map.cells[{1, 4}] = Occupancy::kOccupied;
  CHECK(GuidanceFails(situation));
  situation = OnTheWay();
  situation.state.cell = {2, 2};
  CHECK(GuidanceFails(situation));
  situation.state.cell = {1, 4};
  CHECK(GuidanceFails(situation));
  situation = OnTheWay();
  situation.guidance.reset();
  CHECK(GuidanceFails(situation));
  situation.guided_before = false;
  CHECK_FALSE(GuidanceFails(situation));
}

TEST_CASE("a path that leads out of the map fails", "[planner][communication]") {
  Situation situation = OnTheWay();
  situation.guidance->path.push_back({1, 9});
  CHECK(GuidanceFails(situation));
}

TEST_CASE("moves count from the last picture, or from the start", "[planner][communication]") {
  Situation situation = OnTheWay();
  CHECK(MomentOf(situation).moves_since_picture == 1);
  CHECK_FALSE(MomentOf(situation).sent_before);
  situation.state.path = {{1, 2}};
  situation.state.snapshots = 2;
  CHECK(MomentOf(situation).moves_since_picture == 0);
  CHECK(MomentOf(situation).sent_before);
  situation.state.path = {};
  CHECK(MomentOf(situation).moves_since_picture == 0);
}

TEST_CASE("never is never, also for a robot that is lost", "[planner][communication]") {
  CHECK_FALSE(
      Make({.policy = "never"})->Wants({.moves_since_picture = 90, .guidance_fails = true}));
}

TEST_CASE("random sends at its rate, repeatably", "[planner][communication]") {
  CHECK(Wanted(*Make({.policy = "random", .probability = 0.0}), 50) == 0);
  CHECK(Wanted(*Make({.policy = "random", .probability = 1.0}), 50) == 50);
  const int wanted = Wanted(*Make({.policy = "random", .probability = 0.3}), 2000);
  CHECK(wanted > 500);
  CHECK(wanted < 700);
  CHECK(Wanted(*Make({.policy = "random", .probability = 0.3}), 2000) == wanted);
  CHECK(Wanted(*Make({.policy = "random", .probability = 0.3}, 2), 2000) != wanted);
}

TEST_CASE("every k moves counts moves since the picture", "[planner][communication]") {
  const auto policy = Make({.policy = "every", .every_moves = 3});
  CHECK_FALSE(policy->Wants({.moves_since_picture = 2}));
  CHECK(policy->Wants({.moves_since_picture = 3}));
  CHECK(policy->Wants({.moves_since_picture = 4}));
}

TEST_CASE("when blocked asks once per place", "[planner][communication]") {
  const auto policy = Make({.policy = "when_blocked"});
  CHECK_FALSE(policy->Wants({.moves_since_picture = 7}));
  CHECK(policy->Wants({.guidance_fails = true}));  // at the start
  CHECK_FALSE(policy->Wants({.sent_before = true, .guidance_fails = true}));
  CHECK(policy->Wants({.moves_since_picture = 1, .sent_before = true, .guidance_fails = true}));
}

TEST_CASE("a threshold asks for information only", "[planner][communication]") {
  const auto policy = Make({.policy = "threshold", .threshold_cells = 1.5});
  CHECK(policy->Wants({}));
  CHECK(policy->least_information() == 1.5);
  CHECK(Make({.policy = "random"})->least_information() == 0.0);
}

TEST_CASE("the search has no rule beside it", "[planner][communication]") {
  CHECK(Make({}) == nullptr);
}

TEST_CASE("an unknown policy and parameters out of range are refused by key",
          "[planner][communication]") {
  const auto read = [](const std::string& yaml) {
    CommunicationConfig config;
    ReadConfig(YAML::Load(yaml), "planner.communication", config);
    return config;
  };
  CHECK(read("{policy: every, every_moves: 8}").every_moves == 8);
  CHECK_THROWS_WITH(read("{policy: often}"), Catch::Contains("planner.communication.policy") &&
                                                 Catch::Contains("when_blocked"));
  CHECK_THROWS_WITH(read("{probability: 1.5}"), Catch::Contains("probability"));
  CHECK_THROWS_WITH(read("{every_moves: 0}"), Catch::Contains("every_moves"));
  CHECK_THROWS_WITH(read("{threshold_cells: -1}"), Catch::Contains("threshold_cells"));
}
