#include "nhpm/dataset/annotators.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <optional>

#include "common/runtime/config.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

const std::filesystem::path kShippedFile =
    std::filesystem::path(CONAV_SOURCE_DIR) / "deploy/config/annotators.yaml";

/// From a file with these parameters.
AnnotatorPopulation Read(const std::string& parameters) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "people.yaml") << "annotators:\n  ros__parameters:\n    " << parameters;
  return ReadPopulation(folder / "people.yaml");
}

std::vector<Annotator> DrawMany(const AnnotatorPopulation& population, int count) {
  Random random(3);
  std::vector<Annotator> people;
  for (int i = 0; i < count; ++i) people.push_back(DrawAnnotator(population, random));
  return people;
}

/// Nested ones with dots.
std::set<std::string> KeysOf(const YAML::Node& node) {
  std::set<std::string> keys;
  if (!node.IsMap()) return keys;
  for (const auto& entry : node) {
    const std::string key = entry.first.as<std::string>();
    keys.insert(key);
    for (const std::string& inner : KeysOf(entry.second)) keys.insert(key + "." + inner);
  }
  return keys;
}

TEST_CASE("The shipped file of people holds every key with its default", "[synthesis]") {
  CHECK(ReadPopulation(kShippedFile) == AnnotatorPopulation{});
  ConfigReader writer;
  AnnotatorPopulation().Visit(writer);
  CHECK(KeysOf(LoadParameters(kShippedFile, "annotators")) == KeysOf(writer.emitted()));
}

TEST_CASE("Each of the shipped people can be read, and none is careless", "[synthesis]") {
  const std::filesystem::path folder = kShippedFile.parent_path() / "people";
  int people = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    CAPTURE(file.path());
    const AnnotatorPopulation population = ReadPopulation(file.path());
    CHECK(population.careless_share == 0.0);
    CHECK(Name(population.careful.mechanism) == file.path().stem());
    const auto reader = DrawMany(population, 1).front().reader;
    CHECK(ToNamedValues(*FromNamedValues(ToNamedValues(reader))) == ToNamedValues(reader));
    ++people;
  }
  CHECK(people == static_cast<int>(operators::kReadingMechanisms.size()));
}

TEST_CASE("A wrong file of people is refused by file and key", "[synthesis]") {
  CHECK(Read("careless_share: 0.5").careless_share == 0.5);
  for (const auto& [parameters, names] : std::vector<std::pair<const char*, const char*>>{
           {"careless_share: 1.5", "people.yaml: annotators.careless_share"},
           {"carefull: {}", "'carefull'"},
           {"careful: {edit_probabilty: {mean: 0.5}}", "annotators.careful: unknown key"},
           {"careless: {lapse_probability: {mean: -0.1}}",
            "annotators.careless.lapse_probability.mean"},
           {"careful: {decay_cells: {mean: 0.0}}", "annotators.careful.decay_cells.mean"},
           {"careful: {decay_cells: {deviation: -1}}", "annotators.careful.decay_cells.deviation"},
       }) {
    CHECK_THROWS_WITH(Read(parameters), Catch::Contains(names));
  }
}

TEST_CASE("People differ by the mean and deviation of each parameter", "[synthesis]") {
  AnnotatorPopulation population;
  population.careless_share = 0.0;
  population.careful.edit_probability = {0.625, 0.0};
  population.careful.decay_cells = {4.5, 0.0};
  population.careful.edit_limit = {2.6, 0.0};
  population.careful.extra_pictures = {7.4, 0.0};
  population.careful.misplacement_probability = {0.5, 0.1};
  constexpr int kPeople = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (const Annotator& person : DrawMany(population, kPeople)) {
    REQUIRE(person.reader.edit_probability == 0.625);
    REQUIRE(person.reader.decay_cells == 4.5);
    REQUIRE(person.reader.edit_limit == 3);
    REQUIRE(person.extra_pictures == 7);
    sum += person.reader.misplacement_probability;
    squares += std::pow(person.reader.misplacement_probability - 0.5, 2);
  }
  CHECK(sum / kPeople == Approx(0.5).margin(0.01));
  CHECK(std::sqrt(squares / kPeople) == Approx(0.1).margin(0.01));
}

TEST_CASE(
    "Parameters keep to their ranges however far people differ, and survive the way through names",
    "[synthesis]") {
  AnnotatorPopulation population;
  population.careful.lapse_probability = {0.5, 5.0};
  population.careful.decay_cells = {1.0, 50.0};
  population.careful.edit_limit = {1.0, 50.0};
  bool lowest = false;
  bool highest = false;
  for (const Annotator& person : DrawMany(population, 300)) {
    const auto back = FromNamedValues(ToNamedValues(person.reader));
    REQUIRE(back.has_value());  // which checks every range
    CHECK(ToNamedValues(*back) == ToNamedValues(person.reader));
    lowest = lowest || person.reader.lapse_probability == 0.0;
    highest = highest || person.reader.lapse_probability == 1.0;
  }
  CHECK(lowest);
  CHECK(highest);
}

TEST_CASE("Named values that are missing, unknown or out of range are refused by name",
          "[synthesis]") {
  CHECK_FALSE(FromNamedValues({}));
  for (const auto& [name, value] : std::vector<std::pair<std::string, std::optional<double>>>{
           {"decay_cells", {}},
           {"patience", 1.0},
           {"guess_probability", 1.25},
           {"guess_probability", std::nan("")},
           {"edit_limit", 2.5},
           {"mechanism", 100.0},
       }) {
    auto values = ToNamedValues({});
    if (value) {
      values[name] = *value;
    } else {
      values.erase(name);
    }
    test::CheckRefusal(FromNamedValues(values), Catch::Contains(name));
  }
}

}  // namespace
}  // namespace conav::nhpm
