#include <catch2/catch.hpp>
#include <functional>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "study/design.h"
#include "study/study_run.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"

namespace conav::study {
namespace {

TEST_CASE("Each design has a folder of its own", "[study]") {
  StudyOptions options;
  options.design.operators = 2;
  CHECK(DefaultOut(options, "0a1b2c3d4e5f") == "runs/study-2x3-seed1-0a1b2c3d");
}

TEST_CASE("What cannot be is refused by the option's name and value", "[study]") {
  using O = StudyOptions;
  struct Row {
    std::function<void(O&)> set;
    std::string named;  // "" = accepted
  };
  const test::ScopedVariable domain("CONAV_DOMAIN", "7");
  for (const Row& row : std::vector<Row>{
           {[](O&) {}, ""},
           {[](O& o) { o.out = "runs/study"; }, ""},
           {[](O& o) { o.population = "/none.yaml"; }, "--population: "},
           {[](O& o) { o.design.operators = 0; }, "--operators 0"},
           {[](O& o) { o.design.layouts = 0; }, "--layouts 0"},
           {[](O& o) { o.jobs = 0; }, "--jobs 0"},
           {[](O& o) { o.jobs = 2; }, "--jobs 2: CONAV_DOMAIN"},  // one domain for all of them
           {[](O& o) { o.robots = 0; }, "--robots 0"},
           {[](O& o) { o.robots = 24; }, "--robots 24: the world of seed 234"},  // has no room
           {[](O& o) {
              o.design.methods = {"ig-mcts", "magic"};
            },
            "--methods: magic"},
           {[](O& o) {
              o.design.methods = {"teleop", "teleop"};
            },
            "--methods: "},
           {[](O& o) {
              o.design.methods = {"a", "b", "c", "d", "e"};
            },
            "--methods: 5 "}}) {
    O options;
    row.set(options);
    const auto valid = Validate(options);
    INFO("expected: " << row.named);
    CHECK(valid.has_value() == row.named.empty());
    if (!valid) CHECK_THAT(valid.error().text, Catch::StartsWith(row.named));
  }
}

TEST_CASE("An episode becomes a demo with its own world, seed, person and folder", "[study]") {
  const test::TemporaryFolder parent;
  StudyOptions options;
  options.robots = 2;
  const auto folder = StudyFolder::Open(parent / "study", {{"seed", 1}});
  REQUIRE(folder);
  const Design design = MakeDesign(options.design);
  const PlannedEpisode& episode = design.episodes[5];
  const auto demo = DemoFor(BaseDemo(options), episode, "s01", *folder);
  CHECK(demo.robots == 2);
  CHECK(demo.headless);
  CHECK(demo.camera == "none");
  CHECK(demo.method == episode.method);
  CHECK(demo.world_seed() == episode.maze_seed);
  CHECK(demo.rotation_deg == episode.rotation_deg);
  CHECK(demo.seed == episode.seed);
  CHECK(demo.simulated_operator == (parent / "study/people/s01.yaml").string());
  CHECK(demo.out == parent / "study/runs" / episode.name);
  CHECK_FALSE(demo.recording);  // only when asked to
  options.recording = true;
  CHECK(BaseDemo(options).recording);
}

TEST_CASE("Equal seeds give the same person, others another one", "[study]") {
  const auto population = DefaultPopulation();
  CHECK(PersonYaml(DrawPerson(population, 1)) == PersonYaml(DrawPerson(population, 1)));
  CHECK(PersonYaml(DrawPerson(population, 1)) != PersonYaml(DrawPerson(population, 2)));
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
}

TEST_CASE("A person's file gives the same person to a demo", "[study]") {
  const test::TemporaryFolder folder;
  const auto person = DrawPerson(DefaultPopulation(), 7);
  REQUIRE(WriteFile(folder / "s01.yaml", PersonYaml(person)));
  const auto read = launcher::OperatorPerson((folder / "s01.yaml").string());
  CHECK(read.reader.edit_probability == person.reader.edit_probability);
  CHECK(read.reader.edit_limit == person.reader.edit_limit);
  CHECK(PersonYaml(read) == PersonYaml(person));
}

}  // namespace
}  // namespace conav::study
