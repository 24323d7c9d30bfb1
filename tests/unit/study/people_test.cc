#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "study/study_options.h"
#include "support/temporary_folder.h"

namespace conav::study {
namespace {

TEST_CASE("Equal seeds give the same person, others another one", "[study][people]") {
  const auto population = DefaultPopulation();
  CHECK(PersonYaml(DrawPerson(population, 1)) == PersonYaml(DrawPerson(population, 1)));
  CHECK(PersonYaml(DrawPerson(population, 1)) != PersonYaml(DrawPerson(population, 2)));
}

TEST_CASE("People differ within their limits, around the means", "[study][people]") {
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

TEST_CASE("A person's file gives the same person to a demo", "[study][people]") {
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
