#include "nhpm/dataset/annotators.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

const std::filesystem::path kShippedFile =
    std::filesystem::path(CONAV_SOURCE_DIR) / "deploy/config/annotators.yaml";

/// What reading a file with these parameters throws; empty when it is taken.
std::string Refusal(const std::string& parameters) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "people.yaml") << "annotators:\n  ros__parameters:\n    " << parameters;
  try {
    ReadPopulation(folder / "people.yaml");
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

std::vector<Annotator> DrawMany(const AnnotatorPopulation& population, int count) {
  Random random(3);
  std::vector<Annotator> people;
  for (int i = 0; i < count; ++i) people.push_back(DrawAnnotator(population, random));
  return people;
}

/// Every key of `node`, nested ones with dots.
void CollectKeys(const YAML::Node& node, const std::string& prefix, std::set<std::string>& keys) {
  if (!node.IsMap()) return;
  for (const auto& entry : node) {
    const std::string key = prefix + "." + entry.first.as<std::string>();
    keys.insert(key);
    CollectKeys(entry.second, key, keys);
  }
}

std::set<std::string> KeysOf(const YAML::Node& node) {
  std::set<std::string> keys;
  CollectKeys(node, "", keys);
  return keys;
}

TEST_CASE("The shipped file of people holds every key with its default", "[nhpm][synthesis]") {
  CHECK(ReadPopulation(kShippedFile) == AnnotatorPopulation{});
  ConfigReader writer;
  AnnotatorPopulation().Visit(writer);
  CHECK(KeysOf(LoadParameters(kShippedFile, "annotators")) == KeysOf(writer.emitted()));
}

TEST_CASE("Each of the shipped people can be read, and none is careless", "[nhpm][synthesis]") {
  const std::filesystem::path folder = kShippedFile.parent_path() / "people";
  int people = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    CAPTURE(file.path());
    CHECK(ReadPopulation(file.path()).careless_share == 0.0);
    ++people;
  }
  CHECK(people == 10);
}

TEST_CASE("A file of people changes what it names and keeps the rest", "[nhpm][synthesis]") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "people.yaml")
      << "annotators: {ros__parameters: {careful: {near_cells: {mean: 2.5}}}}";
  AnnotatorPopulation expected;
  expected.careful.near_cells.mean = 2.5;
  CHECK(ReadPopulation(folder / "people.yaml") == expected);
}

TEST_CASE("A wrong file of people is refused by file, key, value and limit", "[nhpm][synthesis]") {
  using Catch::Matchers::Contains;
  CHECK(Refusal("careless_share: 0.5").empty());
  CHECK_THAT(Refusal("careless_share: 1.5"), Contains("people.yaml: annotators.careless_share") &&
                                                 Contains("1.5") && Contains("[0, 1]"));
  CHECK_THAT(Refusal("carefull: {}"), Contains("unknown key 'carefull'"));
  CHECK_THAT(Refusal("careful: {edit_probabilty: {mean: 0.5}}"),
             Contains("annotators.careful: unknown key 'edit_probabilty'"));
  CHECK_THAT(Refusal("careless: {lapse_probability: {mean: -0.1}}"),
             Contains("annotators.careless.lapse_probability.mean") && Contains("[0, 1]"));
  CHECK_THAT(Refusal("careful: {decay_cells: {mean: 0.0}}"),
             Contains("annotators.careful.decay_cells.mean") && Contains("0.1"));
  CHECK_THAT(Refusal("careful: {decay_cells: {deviation: -1}}"),
             Contains("annotators.careful.decay_cells.deviation"));
  CHECK_THAT(Refusal("careful: {decay_cells: {mean: .nan}}"), Contains("decay_cells.mean"));
  CHECK_THAT(Refusal("careful: {decay_cells: {spread: 1}}"), Contains("unknown key 'spread'"));
  CHECK_THAT(Refusal("careful: {decay_cells: 7}"), Contains("expected a mapping"));
  CHECK_THAT(Refusal("careful: {decay_cells: {mean: far}}"), Contains("wrong type"));
}

TEST_CASE("A file of people that is missing or has no people is refused", "[nhpm][synthesis]") {
  CHECK_THROWS_AS(ReadPopulation("/nowhere/people.yaml"), StartupError);
  CHECK_THROWS_AS(
      ReadPopulation(std::filesystem::path(CONAV_SOURCE_DIR) / "deploy/config/nhpm.yaml"),
      StartupError);
}

TEST_CASE("People without spread are all the mean", "[nhpm][synthesis]") {
  AnnotatorPopulation population;
  population.careless_share = 0.0;
  population.careful.edit_probability = {0.625, 0.0};
  population.careful.decay_cells = {4.5, 0.0};
  population.careful.edit_limit = {2.6, 0.0};
  population.careful.extra_pictures = {7.4, 0.0};
  for (const Annotator& person : DrawMany(population, 20)) {
    CHECK(person.reader.edit_probability == 0.625);
    CHECK(person.reader.decay_cells == 4.5);
    CHECK(person.reader.edit_limit == 3);
    CHECK(person.extra_pictures == 7);
  }
}

TEST_CASE("People differ by the mean and deviation of each parameter", "[nhpm][synthesis]") {
  AnnotatorPopulation population;
  population.careless_share = 0.0;
  population.careful.misplacement_probability = {0.5, 0.1};
  constexpr int kPeople = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (const Annotator& person : DrawMany(population, kPeople)) {
    sum += person.reader.misplacement_probability;
    squares += std::pow(person.reader.misplacement_probability - 0.5, 2);
  }
  CHECK(sum / kPeople == Approx(0.5).margin(0.01));
  CHECK(std::sqrt(squares / kPeople) == Approx(0.1).margin(0.01));
}

TEST_CASE("Parameters keep to their ranges however far people differ", "[nhpm][synthesis]") {
  AnnotatorPopulation population;
  population.careful.lapse_probability = {0.5, 5.0};
  population.careful.decay_cells = {1.0, 50.0};
  population.careful.edit_limit = {1.0, 50.0};
  bool lowest = false;
  bool highest = false;
  for (const Annotator& person : DrawMany(population, 300)) {
    CHECK(FromNamedValues(ToNamedValues(person.reader)).has_value());  // which checks every range
    lowest = lowest || person.reader.lapse_probability == 0.0;
    highest = highest || person.reader.lapse_probability == 1.0;
  }
  CHECK(lowest);
  CHECK(highest);
}

TEST_CASE("The careless are as many as the population says", "[nhpm][synthesis]") {
  AnnotatorPopulation population;
  population.careless_share = 0.3;
  population.careful.decay_cells = {20.0, 0.0};
  population.careless.decay_cells = {2.0, 0.0};
  int careless = 0;
  for (const Annotator& person : DrawMany(population, 2000)) {
    careless += person.reader.decay_cells == 2.0;
  }
  CHECK(careless == Approx(600).margin(80));
}

TEST_CASE("Parameters of a reader survive the way through their names", "[nhpm][synthesis]") {
  for (const Annotator& person : DrawMany({}, 50)) {
    const std::map<std::string, double> values = ToNamedValues(person.reader);
    const auto back = FromNamedValues(values);
    REQUIRE(back.has_value());
    CHECK(ToNamedValues(*back) == values);
    CHECK(back->decay_cells == person.reader.decay_cells);
    CHECK(back->edit_limit == person.reader.edit_limit);
  }
}

TEST_CASE("Named values that are missing, unknown or out of range are refused by name",
          "[nhpm][synthesis]") {
  using Catch::Matchers::Contains;
  const std::map<std::string, double> good = ToNamedValues({});
  const auto refusal = [](const std::map<std::string, double>& values) {
    const auto result = FromNamedValues(values);
    return result ? std::string() : result.error().text;
  };
  CHECK(refusal(good).empty());
  auto values = good;
  values.erase("decay_cells");
  CHECK_THAT(refusal(values), Contains("decay_cells"));
  values = good;
  values["patience"] = 1.0;
  CHECK_THAT(refusal(values), Contains("patience"));
  values = good;
  values["guess_probability"] = 1.25;
  CHECK_THAT(refusal(values), Contains("guess_probability") && Contains("1.25"));
  values = good;
  values["guess_probability"] = std::nan("");
  CHECK_THAT(refusal(values), Contains("guess_probability"));
  values = good;
  values["edit_limit"] = 2.5;
  CHECK_THAT(refusal(values), Contains("edit_limit"));
  CHECK_FALSE(refusal({}).empty());
}

}  // namespace
}  // namespace conav::nhpm
