#include <catch2/catch.hpp>

#include "planner/methods/ig_mcts_method.h"

using namespace conav;
using namespace conav::planner;

namespace {

constexpr Cell kEnd{1, 4};

/// A robot in a corridor with a path to its end.
Situation OnTheWay() {
  Situation situation;
  situation.state.cell = {1, 2};
  situation.state.path = {{1, 1}, {1, 2}};
  situation.map.cells = OccupancyGrid(3, 6, Occupancy::kUnknown);
  situation.guidance = Guidance{.path = {{1, 1}, {1, 2}, {1, 3}, kEnd}};
  situation.guided_before = true;
  return situation;
}

int Wanted(CommunicationPolicy policy, int decisions) {
  int wanted = 0;
  for (int i = 0; i < decisions; ++i) wanted += policy.IsDue({}) ? 1 : 0;
  return wanted;
}

}  // namespace

TEST_CASE("guidance fails where it no longer leads on, and never before the first path",
          "[planner][communication]") {
  using S = Situation;
  const std::vector<std::tuple<const char*, bool, void (*)(S&)>> rows{
      {"on the way", false, [](S&) {}},
      {"a known wall ahead", true, [](S& s) { s.map.cells[kEnd] = Occupancy::kOccupied; }},
      {"beside the path", true, [](S& s) { s.state.cell.row = 2; }},
      {"at its end", true, [](S& s) { s.state.cell = kEnd; }},
      {"expired", true, [](S& s) { s.guidance.reset(); }},
      {"out of the map", true, [](S& s) { s.guidance->path.back().column = 9; }},
      {"no way known", true, [](S& s) { s.guidance.reset(), s.lacks_way = true; }},
      {"none so far", false, [](S& s) { s.guidance.reset(), s.guided_before = false; }}};
  for (const auto& [name, fails, change] : rows) {
    Situation situation = OnTheWay();
    change(situation);
    CAPTURE(name);
    CHECK(GuidanceFails(situation) == fails);
  }
}

TEST_CASE("moves count from the last picture, or from the start", "[planner][communication]") {
  Situation situation = OnTheWay();
  CHECK(MomentOf(situation).moves_since_snapshot == 1);
  CHECK_FALSE(MomentOf(situation).sent_before);
  situation.state.path = {{1, 2}};
  situation.state.snapshots = 2;
  CHECK(MomentOf(situation).moves_since_snapshot == 0);
  CHECK(MomentOf(situation).sent_before);
  situation.state.path = {};
  CHECK(MomentOf(situation).moves_since_snapshot == 0);
}

TEST_CASE("each rule wants a picture at its moments", "[planner][communication]") {
  struct Row {
    CommunicationConfig config;
    CommunicationMoment moment;
    bool wanted;
  };
  for (const auto& [config, moment, wanted] : std::vector<Row>{
           {{.policy = "never"}, {.moves_since_snapshot = 90, .guidance_fails = true}, false},
           {{.policy = "threshold"}, {}, true},
           {{.policy = "every", .every_moves = 3}, {.moves_since_snapshot = 2}, false},
           {{.policy = "every", .every_moves = 3}, {.moves_since_snapshot = 3}, true},
           {{.policy = "every", .every_moves = 3}, {.moves_since_snapshot = 4}, true},
           {{.policy = "when_blocked"}, {.moves_since_snapshot = 7}, false},
           {{.policy = "when_blocked"}, {.guidance_fails = true}, true},  // at the start
           {{.policy = "when_blocked"}, {.sent_before = true, .guidance_fails = true}, false},
           {{.policy = "when_blocked"},
            {.moves_since_snapshot = 1, .sent_before = true, .guidance_fails = true},
            true}}) {
    CAPTURE(config.policy, moment.moves_since_snapshot, moment.sent_before);
    CHECK(CommunicationPolicy(config, 1).IsDue(moment) == wanted);
  }
}

TEST_CASE("random sends at its rate, repeatably", "[planner][communication]") {
  const auto of_2000 = [](double probability, std::uint64_t seed = 1) {
    return Wanted(CommunicationPolicy({.policy = "random", .probability = probability}, seed),
                  2000);
  };
  CHECK(of_2000(0.0) == 0);
  CHECK(of_2000(1.0) == 2000);
  CHECK(of_2000(0.3) > 500);
  CHECK(of_2000(0.3) < 700);
  CHECK(of_2000(0.3) == of_2000(0.3));
  CHECK(of_2000(0.3) != of_2000(0.3, 2));
}

TEST_CASE("only a threshold asks for information, and the search has no rule beside it",
          "[planner][communication]") {
  const CommunicationConfig config{.policy = "threshold", .threshold_cells = 1.5};
  CHECK(CommunicationPolicy(config, 1).least_information() == 1.5);
  CHECK(CommunicationPolicy({.policy = "random"}, 1).least_information() == 0.0);
  CHECK(MakeCommunicationPolicy(config, 1).has_value());
  CHECK_FALSE(MakeCommunicationPolicy({}, 1).has_value());
}

TEST_CASE("an unknown policy and parameters out of range are refused by key",
          "[planner][communication]") {
  const auto read = [](const std::string& yaml) {
    CommunicationConfig config;
    ReadConfig(YAML::Load(yaml), "planner.communication", config);
    return config;
  };
  CHECK(read("{policy: every, every_moves: 8}").every_moves == 8);
  for (const auto& [yaml, key] : std::vector<std::pair<const char*, const char*>>{
           {"{policy: often}", "planner.communication.policy"},
           {"{probability: 1.5}", "probability"},
           {"{every_moves: 0}", "every_moves"},
           {"{threshold_cells: -1}", "threshold_cells"}}) {
    CHECK_THROWS_WITH(read(yaml), Catch::Contains(key));
  }
}
