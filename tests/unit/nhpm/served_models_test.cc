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
  std::string StartRefusal() const {
    try {
      const ServedModels models(config);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
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

TEST_CASE("The log names the model with version, checksum and file", "[models]") {
  const ModelBench bench;
  const ServedModels models(bench.config);
  const ModelIdentity identity = models.For("")->identity();
  CHECK(identity == ModelIdentity{"nhpm", "untrained 1", ChecksumOfSeed(1)});
  CHECK_THAT(bench.lines.at(0), Catch::Contains("serving") && Catch::Contains("untrained 1") &&
                                    Catch::Contains(ChecksumOfSeed(1)) &&
                                    Catch::Contains(bench.config.weights));
}

TEST_CASE("Weights that are missing, truncated or changed stop the start, with the file's name",
          "[models]") {
  ModelBench bench;
  for (const std::string& folder : {std::string("/nowhere"), std::string(300, 'x')}) {
    bench.config.person_weights = folder;
    CHECK_THAT(bench.StartRefusal(), Catch::Contains("person_weights = " + folder));
  }
  bench.config.person_weights.clear();
  SECTION("missing") { bench.config.weights = "/nowhere/a.nhpm"; }
  SECTION("truncated") { bench.Spoil("default"); }
  SECTION("one byte is another") {
    std::fstream file(bench.config.weights, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(bench.config.weights) / 2));
    file.put('\x55');
  }
  CHECK_THAT(bench.StartRefusal(), Catch::Contains(bench.config.weights));
}

TEST_CASE("The GLPF needs no file", "[models]") {
  ModelBench bench;
  bench.config.model = PerceptionModelKind::kGlpf;
  bench.config.weights = "/nowhere/a.nhpm";
  ServedModels models(bench.config);
  models.Refresh();
  CHECK(models.For("")->identity() == Glpf().identity());
}

TEST_CASE("A new weights file is taken, and who has the old model keeps it", "[models]") {
  ModelBench bench;
  ServedModels models(bench.config);
  const auto old = models.For("");
  models.Refresh();
  CHECK(models.For("") == old);
  bench.folder.Write("default", test::UntrainedNetwork(2));
  CHECK(models.For("") == old);
  models.Refresh();
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(2));
  CHECK(old->identity().checksum == ChecksumOfSeed(1));
  CHECK(bench.Lines("serving") == 2);
}

TEST_CASE("A bad new file is logged once and leaves the old model, until a good one comes",
          "[models]") {
  ModelBench bench;
  ServedModels models(bench.config);
  bench.Spoil("default");
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("weights rejected") == 1);
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(1));
  fs::remove(bench.config.weights);
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("weights rejected") == 2);
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(1));
  bench.folder.Write("default", test::UntrainedNetwork(3));
  models.Refresh();
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(3));
}

TEST_CASE("A person with weights of their own gets these, everybody else the default", "[models]") {
  ModelBench bench;
  const test::WeightsFolder persons;
  bench.config.person_weights = persons.path().string();
  persons.Write("anna", test::UntrainedNetwork(11));
  ServedModels models(bench.config);
  CHECK(models.persons() == 1);
  CHECK(models.For("anna")->identity().checksum == ChecksumOfSeed(11));
  CHECK(models.For("ben")->identity().checksum == ChecksumOfSeed(1));
  CHECK(models.For("")->identity().checksum == ChecksumOfSeed(1));

  persons.Write("ben", test::UntrainedNetwork(12));
  models.Refresh();
  CHECK(models.For("ben")->identity().checksum == ChecksumOfSeed(12));
  fs::remove(persons.path() / "anna.nhpm");
  models.Refresh();
  CHECK(models.For("anna")->identity().checksum == ChecksumOfSeed(1));
  CHECK(models.persons() == 1);
}

TEST_CASE("A persons' folder that cannot be read is logged once and leaves the models",
          "[models]") {
  ModelBench bench;
  const test::TemporaryFolder parent;
  const fs::path persons = parent / "persons";
  fs::create_directory(persons);
  REQUIRE(WriteWeightsFile(persons / "anna.nhpm", test::UntrainedNetwork(11)));
  bench.config.person_weights = persons.string();
  ServedModels models(bench.config);
  fs::rename(persons, parent / "elsewhere");
  models.Refresh();
  models.Refresh();
  CHECK(bench.Lines("cannot read the persons' weights") == 1);
  CHECK(models.For("anna")->identity().checksum == ChecksumOfSeed(11));
  fs::create_directory(persons);
  models.Refresh();
  CHECK(models.For("anna")->identity().checksum == ChecksumOfSeed(1));
}

TEST_CASE("A person's bad file is logged once, and they get the default", "[models]") {
  ModelBench bench;
  const test::WeightsFolder persons;
  bench.config.person_weights = persons.path().string();
  std::ofstream(persons.path() / "anna.nhpm") << "no weights";
  std::ofstream(persons.path() / "notes.txt") << "not looked at";
  ServedModels models(bench.config);
  models.Refresh();
  CHECK(bench.Lines("weights rejected person=anna") == 1);
  CHECK(models.For("anna")->identity().checksum == ChecksumOfSeed(1));
}

}  // namespace
}  // namespace conav::nhpm
