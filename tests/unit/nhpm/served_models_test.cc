#include <catch2/catch.hpp>
#include <fstream>

#include "common/runtime/log.h"
#include "nhpm/nhpm_service.h"
#include "support/test_weights.h"

namespace conav::nhpm {
namespace {

namespace fs = std::filesystem;

/// A service's models from files in a folder of its own, and what they say in the log.
class ModelBench {
 public:
  ModelBench() {
    config.model = PerceptionModelKind::kNhpm;
    config.weights = folder.Write("default", test::UntrainedNetwork(1));
    log::SetSink([this](const log::Record& record) { lines.emplace_back(record.text); });
  }
  ~ModelBench() { log::SetSink(nullptr); }

  void Spoil(const std::string& name) {
    const fs::path file = folder.path() / (name + ".nhpm");
    fs::resize_file(file, fs::file_size(file) / 2);
  }
  int Lines(const std::string& text) const {
    int count = 0;
    for (const std::string& line : lines) count += line.starts_with(text) ? 1 : 0;
    return count;
  }

  test::WeightsFolder folder;
  NhpmConfig config;
  std::vector<std::string> lines;
};

std::string ChecksumOfSeed(std::uint64_t seed) { return ChecksumOf(test::UntrainedNetwork(seed)); }

TEST_CASE("Weights or persons' folders that are missing stop the start by name", "[models]") {
  ModelBench bench;
  for (const std::string& folder : {std::string("/nowhere"), std::string(300, 'x')}) {
    bench.config.person_weights = folder;
    CHECK_THROWS_WITH(ServedModels(bench.config), Catch::Contains("person_weights = " + folder));
  }
  bench.config.person_weights.clear();
  bench.config.weights = "/nowhere/a.nhpm";
  CHECK_THROWS_WITH(ServedModels(bench.config), Catch::Contains(bench.config.weights));
  bench.config.model = PerceptionModelKind::kGlpf;  // needs no file
  ServedModels models(bench.config);
  models.Refresh();
  CHECK(models.For("")->identity() == Glpf().identity());
}

TEST_CASE("A new weights file is taken, a bad one is logged once and leaves the old model",
          "[models]") {
  ModelBench bench;
  ServedModels models(bench.config);
  const auto old = models.For("");
  CHECK(old->identity() == ModelIdentity{"nhpm", "untrained 1", ChecksumOfSeed(1)});
  CHECK_THAT(bench.lines.at(0), Catch::Contains("untrained 1") &&
                                    Catch::Contains(ChecksumOfSeed(1)) &&
                                    Catch::Contains(bench.config.weights));
  models.Refresh();
  CHECK(models.For("") == old);
  bench.Spoil("default");
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("weights rejected") == 1);
  fs::remove(bench.config.weights);
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("weights rejected") == 2);
  bench.folder.Write("default", test::UntrainedNetwork(2));
  CHECK(models.For("") == old);
  models.Refresh();
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(2));
  CHECK(old->identity().checksum == ChecksumOfSeed(1));
  CHECK(bench.Lines("serving") == 2);
}

TEST_CASE("A person with weights of their own gets these, everybody else the default", "[models]") {
  ModelBench bench;
  const test::TemporaryFolder parent;
  const fs::path persons = parent / "persons";
  fs::create_directory(persons);
  const auto write = [&](const char* name, std::uint64_t seed) {
    REQUIRE(WriteWeightsFile(persons / name, test::UntrainedNetwork(seed)));
  };
  write("anna.nhpm", 11);
  std::ofstream(persons / "carl.nhpm") << "no weights";
  std::ofstream(persons / "notes.txt") << "not looked at";
  bench.config.person_weights = persons.string();
  ServedModels models(bench.config);
  models.Refresh();
  const auto seed_of = [&](const std::string& person, std::uint64_t seed) {
    return models.For(person)->identity().checksum == ChecksumOfSeed(seed);
  };
  CHECK(models.persons() == 1);
  CHECK(seed_of("anna", 11));
  for (const char* other : {"ben", "carl", ""}) CHECK(seed_of(other, 1));
  CHECK(bench.Lines("weights rejected person=carl") == 1);

  write("ben.nhpm", 12);
  models.Refresh();
  CHECK(seed_of("ben", 12));
  fs::rename(persons, parent / "elsewhere");  // a folder that cannot be read leaves the models
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("cannot read the persons' weights") == 1);
  CHECK(seed_of("anna", 11));
  fs::create_directory(persons);
  models.Refresh();
  CHECK(seed_of("anna", 1));
  CHECK(models.persons() == 0);
}

}  // namespace
}  // namespace conav::nhpm
