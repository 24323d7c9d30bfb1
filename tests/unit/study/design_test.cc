#include "study/design.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <ranges>
#include <set>
#include <tuple>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "study/study_episode.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"

namespace conav::study {
namespace {

TEST_CASE("A Williams design balances places and followers for even and odd numbers", "[study]") {
  for (const int conditions : {2, 3, 4, 5, 6, 7, 8}) {
    CAPTURE(conditions);
    const auto orders = WilliamsDesign(conditions);
    const int rows = conditions % 2 == 0 ? conditions : 2 * conditions;
    CHECK(orders.size() == static_cast<std::size_t>(rows));
    std::map<std::pair<int, std::size_t>, int> at_place;
    std::map<std::pair<int, int>, int> after;
    for (const auto& order : orders) {
      REQUIRE(std::ranges::is_permutation(order, std::views::iota(0, conditions)));
      for (std::size_t place = 0; place < order.size(); ++place) {
        ++at_place[{order[place], place}];
        if (place > 0) ++after[{order[place - 1], order[place]}];
      }
    }
    // Each condition is as often at each place, and right after each other one.
    CHECK(at_place.size() == static_cast<std::size_t>(conditions * conditions));
    for (const auto& [key, count] : at_place) CHECK(count == rows / conditions);
    CHECK(after.size() == static_cast<std::size_t>(conditions * (conditions - 1)));
    for (const auto& [key, count] : after) CHECK(count == rows / conditions);
  }
  CHECK(WilliamsDesign(1) == std::vector<std::vector<int>>{{0}});
}

TEST_CASE("Everybody has every method once on every layout", "[study]") {
  const Design design = MakeDesign({});
  REQUIRE(design.episodes.size() == 126);
  CHECK(design.layouts == std::vector<std::uint64_t>{234, 666, 9});
  CHECK(design.subjects.front() == "s01");
  std::set<std::tuple<int, MethodKind, std::uint64_t>> seen;
  std::set<std::string> names;
  std::set<std::uint64_t> seeds;
  for (const PlannedEpisode& episode : design.episodes) {
    seen.insert({episode.subject, episode.row.method, episode.maze_seed});
    names.insert(episode.name);
    seeds.insert(episode.seed);
    CHECK(episode.row.method == design.orders[static_cast<std::size_t>(episode.subject)]
                                             [static_cast<std::size_t>(episode.session)]);
  }
  CHECK(seen.size() == 126);
  CHECK(names.size() == 126);
  CHECK(seeds.size() == 126);
  for (const int block : {0, 6}) {  // every order of the design once
    CHECK(std::set(design.orders.begin() + block, design.orders.begin() + block + 6).size() == 6);
  }
}

TEST_CASE("Nobody sees a layout twice the same way round, and methods share the orientations",
          "[study]") {
  for (const int methods : {1, 2, 3, 4}) {
    DesignOptions options{.operators = 5, .layouts = 4};
    options.methods.assign(kDemoMethods.begin(), kDemoMethods.begin() + methods);
    std::set<std::tuple<int, std::uint64_t, int>> seen;
    for (const PlannedEpisode& episode : MakeDesign(options).episodes) {
      CHECK(seen.insert({episode.subject, episode.maze_seed, episode.rotation_deg}).second);
      CHECK(episode.rotation_deg % 90 == 0);
      if (methods == 3) CHECK(episode.rotation_deg <= 180);
    }
  }
  std::map<std::pair<MethodKind, int>, int> count;  // over three whole blocks
  for (const PlannedEpisode& episode : MakeDesign({.operators = 18, .layouts = 1}).episodes) {
    ++count[{episode.row.method, episode.rotation_deg}];
  }
  CHECK(count.size() == 9);
  for (const auto& [key, times] : count) CHECK(times == 6);
}

TEST_CASE("The seed alone decides orders, layouts beyond the third, and episodes' seeds",
          "[study]") {
  const DesignOptions options{.operators = 6, .layouts = 5, .seed = 3};
  DesignOptions other = options;
  other.seed = 4;
  const Design design = MakeDesign(options);
  const Design same = MakeDesign(options);
  REQUIRE(design.layouts.size() == 5);
  CHECK(std::set<std::uint64_t>(design.layouts.begin(), design.layouts.end()).size() == 5);
  CHECK(same.orders == design.orders);
  CHECK(same.layouts == design.layouts);
  CHECK(same.episodes.back().seed == design.episodes.back().seed);
  CHECK(MakeDesign(other).layouts != design.layouts);
  CHECK(MakeDesign(other).episodes.back().seed != design.episodes.back().seed);
}

TEST_CASE("Methods are read by their names, each once", "[study]") {
  using Names = std::vector<std::string>;
  CHECK(ParseMethods({"teleop", "ig-mcts"}, kStudyMethods).value() ==
        std::vector{MethodKind::kTeleop, MethodKind::kIgMcts});
  for (const Names& names :
       {Names{}, Names{"teleop", "teleop"}, Names{"magic"}, Names{"ig-mcts", "greedy"}}) {
    const auto rejected = ParseMethods(names, kStudyMethods);
    REQUIRE_FALSE(rejected);
    CHECK_THAT(rejected.error().text, Catch::StartsWith("--methods: ") &&
                                          Catch::Contains(names.empty() ? "empty" : names.back()));
  }
}

TEST_CASE("Impossible options are rejected by the option's name and value", "[study]") {
  using O = StudyOptions;
  const test::ScopedVariable domain("CONAV_DOMAIN", "7");
  for (const auto& [set, named] : std::vector<std::pair<void (*)(O&), std::string>>{
           {[](O&) {}, ""},  // accepted
           {[](O& o) { o.out = "runs/study"; }, ""},
           {[](O& o) { o.population = "/none.yaml"; }, "--population: "},
           {[](O& o) { o.design.operators = 0; }, "--operators 0"},
           {[](O& o) { o.design.layouts = 0; }, "--layouts 0"},
           {[](O& o) { o.jobs = 0; }, "--jobs 0"},
           {[](O& o) {
              o.design.teleop_speeds = {0.8, 1.2, 1.2};
            },
            "teleop-1.2: is named twice"},
           {[](O& o) { o.design.methods.assign(kMethods.begin(), kMethods.begin() + 5); },
            "--methods: 5"},
           {[](O& o) { o.jobs = 2; }, "--jobs 2: CONAV_DOMAIN"},  // one domain for all of them
           {[](O& o) { o.robots = 0; }, "--robots 0"},
           {[](O& o) { o.robots = 24; }, "--robots 24: the world of seed 234"}}) {  // has no room
    O options;
    set(options);
    const auto valid = Validate(options);
    INFO("expected: " << named);
    CHECK(valid.has_value() == named.empty());
    if (!valid) CHECK_THAT(valid.error().text, Catch::StartsWith(named));
  }
}

TEST_CASE("An episode becomes a demo with its own world, seed, person and folder", "[study]") {
  StudyOptions options;
  options.robots = 2;
  options.design.operators = 2;
  CHECK(DefaultOut(options, "0a1b2c3d4e5f") == "runs/study-2x3-seed1-0a1b2c3d");
  const Design design = MakeDesign(options.design);
  const PlannedEpisode& episode = design.episodes[5];
  const auto demo = DemoFor(BaseDemo(options), episode, "s01", "/data/study");
  CHECK(demo.robots == 2);
  CHECK(demo.headless);
  CHECK(demo.camera == "none");
  CHECK(demo.method == episode.row.method);
  CHECK(demo.world_seed() == episode.maze_seed);
  CHECK(demo.rotation_deg == episode.rotation_deg);
  CHECK(demo.seed == episode.seed);
  CHECK(demo.teleop_mps == 0.8);
  CHECK(demo.simulated_operator == "/data/study/people/s01.yaml");
  CHECK(demo.out == "/data/study/runs/" + episode.name);
  CHECK_FALSE(demo.recording);  // only when asked to
  options.recording = true;
  CHECK(BaseDemo(options).recording);
  options.recording = false;
  options.h264 = true;
  CHECK(BaseDemo(options).recording);
  CHECK(BaseDemo(options).streams);
  CHECK_THAT(Validate(options).error().text, Catch::StartsWith("--h264: needs --camera egl"));
}

TEST_CASE("A reference has the paper's search, whatever the study's", "[study]") {
  StudyOptions options;
  options.design.operators = 1;
  options.design.layouts = 1;
  options.design.references = {"greedy", "never-send", "paper-2000"};
  options.search = "building";
  REQUIRE(Validate(options));
  std::map<std::string, std::string> searches;
  for (const PlannedEpisode& episode : MakeDesign(options.design).episodes) {
    searches[episode.row.name] = DemoFor(BaseDemo(options), episode, "s01", "study").search;
  }
  CHECK(searches == std::map<std::string, std::string>{{"ig-mcts", "building"},
                                                       {"instruction", ""},
                                                       {"teleop", ""},
                                                       {"greedy", ""},
                                                       {"never-send", "building"},
                                                       {"paper-2000", "paper-2000"}});
}

TEST_CASE("People differ within their limits, around the means", "[study]") {
  const auto population = DefaultPopulation();
  double crossing = 0.0;
  constexpr int kPeople = 400;
  for (int i = 0; i < kPeople; ++i) {
    const auto person = DrawPerson(population, static_cast<std::uint64_t>(i));
    CHECK((person.planner.wall_crossing_cost >= 4.0 && person.planner.wall_crossing_cost <= 16.0));
    CHECK((person.glance_rate >= 0.01 && person.glance_rate <= 0.05));
    CHECK((person.steering.reaction_steps == 1 || person.steering.reaction_steps == 2));
    CHECK(person.steering.slip_probability <= 0.05);
    CHECK_FALSE(person.silent);
    crossing += person.planner.wall_crossing_cost / kPeople;
  }
  CHECK(crossing == Approx(10.0).margin(0.4));
  const test::TemporaryFolder folder;  // a file gives the person of its seed to a demo
  const std::string text = PersonYaml(DrawPerson(population, 7));
  REQUIRE(WriteFile(folder / "s01.yaml", text));
  CHECK(PersonYaml(launcher::OperatorPerson((folder / "s01.yaml").string())) == text);
  CHECK(PersonYaml(DrawPerson(population, 8)) != text);
}

}  // namespace
}  // namespace conav::study
