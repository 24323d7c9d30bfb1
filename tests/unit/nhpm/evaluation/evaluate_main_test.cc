#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/annotators.h"
#include "nhpm/model/weights_file.h"
#include "support/program_runner.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

using Folder = test::ArgumentFolder;
using Ended = test::ProgramOutcome;

Ended Run(const std::string& arguments) { return test::RunProgram("conav-evaluate", arguments); }

/// Both files as arguments, without the oracle, which takes its time.
std::string Of(const std::string& data, const std::string& weights) {
  return fmt::format("--data {} --weights {} --oracle-draws 0 ", data, weights);
}

/// Synthetic trajectories on 9 x 9 maps, written to `file`.
std::string WriteData(const std::string& file, int trajectories = 6,
                      SegmentOrigin origin = SegmentOrigin::kSynthetic) {
  Glpf people({.rho = 0.01});
  SegmentSet set = SegmentsOf(people, trajectories, 4, 3);
  for (Trajectory& trajectory : set.trajectories) {
    trajectory.origin = origin;
    trajectory.annotator = ToNamedValues(operators::PictureReaderParameters{});
    for (Segment& segment : trajectory.segments) {
      segment.query.belief[segment.query.cell] = 0.0F;
      segment.belief_after[segment.query.cell] = 0.0F;
    }
  }
  REQUIRE(WriteSegmentFile(file, set));
  return file;
}

/// Weights that say they learned from `data` with the default split seed; from nobody knows what
/// where there is none.
std::string WriteWeights(const std::string& file, const std::string& data, int side = 9) {
  NetworkModel model;
  model.version = "of a test";
  model.weights = InitialWeights({16}, 5);
  model.rows = side;
  model.columns = side;
  model.data_origin = "synthetic";
  if (!data.empty()) {
    const auto read = ReadIdentifiedSegments(data);
    REQUIRE(read);
    const SegmentSplit split = SplitSegments(read->set, kDefaultSplitSeed);
    model.training = {{"data_sha256", read->checksum}, {"split_seed", "1"}};
    model.learned_from = Union(FingerprintsOf(split.train), FingerprintsOf(split.validation));
  }
  REQUIRE(WriteWeightsFile(file, model));
  return file;
}

nlohmann::json ReadJson(const std::string& file) {
  return nlohmann::json::parse(*ReadFile(file), nullptr, false);
}

/// A folder with data, and weights that learned from it.
struct Bench : Folder {
  explicit Bench(int trajectories = 6, SegmentOrigin origin = SegmentOrigin::kSynthetic)
      : data(WriteData(*this / "data.pb.zst", trajectories, origin)),
        weights(WriteWeights(*this / "w.nhpm", data)) {}

  Ended Run(const std::string& flags) const {
    return nhpm::Run(fmt::format("--data {} --weights {} {}", data, weights, flags));
  }
  std::string data;
  std::string weights;
};

TEST_CASE("conav evaluate prints table 1 and writes JSON, CSV and a page", "[evaluate]") {
  const Bench folder;
  const Ended ended =
      folder.Run(fmt::format("--oracle-draws 2000 --json {} --csv {} --html {}", folder / "r.json",
                             folder / "r.csv", folder / "r.html"));
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("synthetic data, data.pb.zst: test 1 trajectory"));
  CHECK_THAT(ended.text(), !Catch::Contains("warning"));
  const auto json = ReadJson(folder / "r.json");
  for (const char* key : {"glpf_train", "glpf_test", "nhpm", "oracle"}) {
    CHECK(json["models"][key]["mbce_all"].get<double>() > 0.0);
    CHECK_THAT(ended.text(), Catch::Contains(fmt::format(
                                 "{:.5f}", json["models"][key]["mbce_all"].get<double>())));
  }
  CHECK(json["bars"]["excess_share"]["passed"] == false);  // it learned nothing
  CHECK(json["models"]["nhpm"]["checksum"].get<std::string>().size() == 64);
  CHECK_THAT(*ReadFile(folder / "r.html"), Catch::Contains("</html>"));
  CHECK_THAT(*ReadFile(folder / "r.csv"), Catch::Contains("\noracle,"));
}

TEST_CASE("Equal arguments give equal figures, on any number of threads", "[evaluate]") {
  const Bench folder(9);
  const std::string flags = "--oracle-draws 2000 --average-oracle --json - --threads ";
  const Ended one = folder.Run(flags + "1");
  CHECK(one.exit_code == 0);
  CHECK(one.out == folder.Run(flags + "3").out);
  const auto json = nlohmann::json::parse(one.out, nullptr, false);
  CHECK(json["models"].contains("oracle_average"));
}

TEST_CASE("Each input left out and each weights file has a row of its own", "[evaluate]") {
  const Bench folder;
  const Ended ended =
      folder.Run(fmt::format("--weights {} --without tau,o --oracle-draws 0 --json {}",
                             folder.weights, folder / "r.json"));
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  const auto models = ReadJson(folder / "r.json")["models"];
  CHECK(models.size() == 8);
  CHECK(models["nhpm"]["mbce_all"] == models["nhpm_2"]["mbce_all"]);
  CHECK(models["nhpm_without_tau"]["mbce_all"] != models["nhpm"]["mbce_all"]);
  CHECK(models["nhpm_without_tau"]["checksum"] != models["nhpm"]["checksum"]);
  CHECK(models.contains("nhpm_2_without_o"));
}

TEST_CASE("People are no oracle, and their data is not called synthetic", "[evaluate]") {
  const Bench folder(6, SegmentOrigin::kPerson);
  const Ended ended = folder.Run("--json " + (folder / "r.json"));
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("people data"));
  CHECK_FALSE(ReadJson(folder / "r.json")["models"].contains("oracle"));
  CHECK(ReadJson(folder / "r.json")["bars"].empty());
  CHECK_THAT(ended.text(), !Catch::Contains("FAIL"));
  CHECK(folder.Run("--check").exit_code == 2);
  CHECK(folder.Run("--average-oracle").exit_code == 2);
}

TEST_CASE("Weights that never saw an input have no further row without it", "[evaluate]") {
  const Bench folder;
  NetworkModel model = *ReadWeightsFile(folder.weights);
  model.inputs.path = false;
  REQUIRE(WriteWeightsFile(folder.weights, model));
  const Ended ended = folder.Run("--without tau,o --oracle-draws 0 --json " + (folder / "r.json"));
  CHECK(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("w.nhpm: trained without tau"));
  const auto models = ReadJson(folder / "r.json")["models"];
  CHECK_FALSE(models.contains("nhpm_without_tau"));
  CHECK(models.contains("nhpm_without_o"));
}

TEST_CASE("A file's name need not be text", "[evaluate]") {
  const Folder folder;
  const std::string data = WriteData(folder / "d\xff.pb.zst");
  const Ended ended = Run(Of(data, WriteWeights(folder / "w.nhpm", data)) + "--json -");
  CHECK(ended.exit_code == 0);
  CHECK(nlohmann::json::parse(ended.out)["data"]["file"] == "d\uFFFD.pb.zst");
}

TEST_CASE("Data without a test part is refused, unless all of it is test", "[evaluate]") {
  const Folder folder;
  const std::string data = WriteData(folder / "data.pb.zst", 1);
  const std::string weights = WriteWeights(folder / "w.nhpm", "");
  const Ended refused = Run(Of(data, weights));
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text(), Catch::Contains("data.pb.zst: nothing is left"));
  const Ended whole = Run(Of(data, weights) + "--all-test --json " + (folder / "r.json"));
  CHECK(whole.exit_code == 0);
  CHECK_THAT(whole.text(), Catch::Contains("the whole file is test"));
  CHECK_FALSE(ReadJson(folder / "r.json")["models"].contains("glpf_train"));
}

TEST_CASE("Weights that saw the test part are refused", "[evaluate]") {
  const Bench folder(9);
  CHECK(folder.Run("--oracle-draws 0").exit_code == 0);
  const Ended refused = folder.Run("--oracle-draws 0 --all-test");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text(), Catch::Contains("w.nhpm: learned from 8 of the 9 test"));
  CHECK_THAT(refused.text(), Catch::Contains("--split-seed 1, or --allow-seen"));
  const Ended allowed = folder.Run("--oracle-draws 0 --all-test --allow-seen");
  CHECK(allowed.exit_code == 0);
  CHECK_THAT(allowed.text(), Catch::Contains("warning: "));
}

TEST_CASE("Weights that saw some of a file are refused, whatever file they learned from",
          "[evaluate]") {
  const Bench folder(12);
  const SegmentSet whole = *ReadSegmentFile(folder.data);
  SegmentSet set = whole;
  SECTION("one that begins with the same trajectories") { set.trajectories.resize(6); }
  SECTION("one that they were merged into") {
    EvenModel even(0.0F);
    SegmentSet merged = SegmentsOf(even, 2, 4, 9);
    for (Trajectory& trajectory : merged.trajectories) {
      trajectory.participant = "new";
      trajectory.annotator = whole.trajectories.front().annotator;
      set.trajectories.push_back(trajectory);
    }
  }
  REQUIRE(WriteSegmentFile(folder / "other.pb.zst", set));
  const Ended refused = Run(Of(folder / "other.pb.zst", folder.weights) + "--all-test");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text(), Catch::Contains("pass data that it never saw"));
}

TEST_CASE("Weights of other data are fine, those of nobody knows what give a warning",
          "[evaluate]") {
  const Folder folder;
  const std::string data = WriteData(folder / "data.pb.zst");
  SegmentSet others = *ReadSegmentFile(data);
  for (Trajectory& trajectory : others.trajectories) trajectory.session = "another";
  REQUIRE(WriteSegmentFile(folder / "other.pb.zst", others));
  const Ended of_other = Run(Of(data, WriteWeights(folder / "a.nhpm", folder / "other.pb.zst")));
  CHECK(of_other.exit_code == 0);
  CHECK_THAT(of_other.text(), !Catch::Contains("warning"));
  CHECK_THAT(Run(Of(data, WriteWeights(folder / "b.nhpm", ""))).text(),
             Catch::Contains("warning: " + (folder / "b.nhpm")));
}

TEST_CASE("Files that are not what they should be are named", "[evaluate]") {
  const Bench folder;
  const std::string large = WriteWeights(folder / "large.nhpm", folder.data, 13);
  for (const auto& [arguments, names] : std::vector<std::pair<std::string, std::string>>{
           {Of(folder.weights, folder.weights), "w.nhpm"},
           {Of(folder.data, folder.data), "data.pb.zst"},
           {Of(folder.data, large), "large.nhpm"},
           {Of(folder.data, large), "13 x 13"},
       }) {
    const Ended ended = Run(arguments);
    CHECK(ended.exit_code == 1);
    CHECK_THAT(ended.text(), Catch::StartsWith("conav evaluate: ") && Catch::Contains(names));
  }
}

TEST_CASE("Synthetic data without its annotators has no oracle and says why", "[evaluate]") {
  const Folder folder;
  SegmentSet set = *ReadSegmentFile(WriteData(folder / "data.pb.zst"));
  for (Trajectory& trajectory : set.trajectories) trajectory.annotator.clear();
  REQUIRE(WriteSegmentFile(folder / "data.pb.zst", set));
  const std::string common = fmt::format("--data {} --weights {} ", folder / "data.pb.zst",
                                         WriteWeights(folder / "w.nhpm", ""));
  const Ended ended = Run(common);
  CHECK(ended.exit_code == 1);
  CHECK_THAT(ended.text(), Catch::Contains("data.pb.zst: test part: trajectory 0"));
  CHECK(Run(common + "--oracle-draws 0").exit_code == 0);
}

TEST_CASE("Options out of range or that contradict each other are wrong use", "[evaluate]") {
  const Bench folder;
  for (const char* wrong :
       {"--without y", "--without tau,tau", "--oracle-draws 100", "--json - --csv -", "--threads 0",
        "--segments x", "--segments -1", "--split-seed -1", "--split-seed 1 --all-test",
        "--average-oracle --oracle-draws 0", "--average-oracle --all-test"}) {
    INFO(wrong);
    CHECK(folder.Run(wrong).exit_code == 2);
  }
  const Ended ended = folder.Run("--segments 400");
  CHECK(ended.exit_code == 2);
  CHECK_THAT(ended.text(), Catch::Contains("segments 0 to 3"));
}

TEST_CASE("A report does not go over what it is of", "[evaluate]") {
  const Bench folder;
  CHECK(folder.Run("--json " + folder.data).exit_code == 2);
  CHECK(folder.Run("--html " + folder.weights).exit_code == 2);
  CHECK(folder.Run(fmt::format("--csv {0} --html {0}", folder / "r")).exit_code == 2);
  CHECK(ReadSegmentFile(folder.data));
  CHECK(ReadWeightsFile(folder.weights));
}

TEST_CASE("The page shows the segments that were asked for", "[evaluate]") {
  const Ended ended = Bench().Run("--oracle-draws 0 --segments 2,0 --html -");
  CHECK(ended.exit_code == 0);
  CHECK_THAT(ended.out, Catch::StartsWith("<!DOCTYPE html>"));
  CHECK_THAT(ended.text(), Catch::Contains("Test segment 2: by request"));
  CHECK_THAT(ended.text(), !Catch::Contains("Test segment 1:"));
}

TEST_CASE("With --check a bar that is not reached is a failure", "[evaluate]") {
  const Bench folder;
  CHECK(folder.Run("--oracle-draws 2000").exit_code == 0);
  const Ended checked = folder.Run("--oracle-draws 2000 --check");
  CHECK(checked.exit_code == 1);
  CHECK_THAT(checked.text(), Catch::Contains("FAIL"));
}

}  // namespace
}  // namespace conav::nhpm
