#include "study/study_options.h"

#include <catch2/catch.hpp>

#include "study/study_run.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"

namespace conav::study {
namespace {

std::string Refusal(const StudyOptions& options) {
  const auto valid = Validate(options);
  return valid ? "" : valid.error().text;
}

StudyOptions Good() {
  StudyOptions options;
  options.out = "runs/study";
  return options;
}

TEST_CASE("The paper's study is accepted", "[study][options]") {
  CHECK(Refusal(Good()).empty());
  CHECK(Refusal({}).empty());
}

TEST_CASE("Each design has a folder of its own", "[study][options]") {
  StudyOptions options;
  options.design.operators = 2;
  CHECK(DefaultOut(options, "0a1b2c3d4e5f") == "runs/study-2x3-seed1-0a1b2c3d");
}

TEST_CASE("A population that cannot be read is refused", "[study][options]") {
  StudyOptions options = Good();
  options.population = "/none.yaml";
  CHECK_THAT(Refusal(options),
             Catch::StartsWith("--population: ") && Catch::Contains("/none.yaml"));
}

TEST_CASE("Numbers and methods that cannot be are refused by the option's name",
          "[study][options]") {
  StudyOptions options = Good();
  options.design.operators = 0;
  CHECK(Refusal(options) == "--operators 0: not between 1 and 10000");
  options = Good();
  options.design.layouts = 0;
  CHECK_THAT(Refusal(options), Catch::StartsWith("--layouts 0"));
  options = Good();
  options.jobs = 0;
  CHECK_THAT(Refusal(options), Catch::StartsWith("--jobs 0"));
  options = Good();
  options.robots = 0;
  CHECK_THAT(Refusal(options), Catch::StartsWith("--robots 0"));
  options = Good();
  options.design.methods = {"ig-mcts", "magic"};
  CHECK_THAT(Refusal(options), Catch::StartsWith("--methods: magic is not one of ig-mcts, instr"));
  options.design.methods = {"teleop", "teleop"};
  CHECK(Refusal(options) == "--methods: one is named twice");
  options.design.methods = {"a", "b", "c", "d", "e"};
  CHECK_THAT(Refusal(options), Catch::StartsWith("--methods: 5 of them; 1 to 4"));
}

TEST_CASE("Several jobs need more than the one domain that the environment leaves",
          "[study][options]") {
  const test::ScopedVariable domain("CONAV_DOMAIN", "7");
  StudyOptions options = Good();
  CHECK(Refusal(options).empty());
  options.jobs = 2;
  CHECK(Refusal(options) == "--jobs 2: CONAV_DOMAIN leaves one DDS domain for all of them");
}

TEST_CASE("More robots than a layout has room for are refused with its seed", "[study][options]") {
  StudyOptions options = Good();
  options.robots = 24;
  CHECK_THAT(Refusal(options),
             Catch::StartsWith("--robots 24: the world of seed 234 has room for"));
}

TEST_CASE("An episode becomes a demo with its own world, seed, person and folder",
          "[study][options]") {
  const test::TemporaryFolder parent;
  StudyOptions options = Good();
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
}

TEST_CASE("a study records its episodes only when asked to", "[study]") {
  StudyOptions options;
  CHECK_FALSE(BaseDemo(options).recording);
  options.recording = true;
  CHECK(BaseDemo(options).recording);
}

}  // namespace
}  // namespace conav::study
