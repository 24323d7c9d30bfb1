#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/annotators.h"
#include "support/program_runner.h"
#include "support/test_weights.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

using Ended = test::ProgramOutcome;

/// Synthetic trajectories on 9 x 9 maps.
SegmentSet Synthetic(int trajectories) {
  Glpf people({.rho = 0.01});
  SegmentSet set = SegmentsOf(people, trajectories, 4, 3);
  for (Trajectory& trajectory : set.trajectories) {
    trajectory.annotator = ToNamedValues(operators::SnapshotReaderParameters{});
    for (Segment& segment : trajectory.segments) {
      segment.query.belief[segment.query.cell] = segment.belief_after[segment.query.cell] = 0.0F;
    }
  }
  return set;
}

/// A folder with data in "d", weights "w" that learned from it, and conav-evaluate run there.
struct Bench : test::ProgramRunner {
  explicit Bench(int trajectories = 6) : Bench(Synthetic(trajectories)) {}
  explicit Bench(SegmentSet data) : ProgramRunner("conav-evaluate"), set(std::move(data)) {
    Write("d", set);
    WriteWeights("w", "d");
  }

  void Write(const char* name, const SegmentSet& written) const {
    REQUIRE(WriteSegmentFile(*this / name, written));
  }
  /// Weights that say they learned from `data` with the default split seed; from nobody knows what
  /// where there is none.
  void WriteWeights(const char* name, const std::string& data, int side = 9) const {
    NetworkModel model = test::UntrainedNetwork(5, side, side);
    if (!data.empty()) {
      const auto read = ReadIdentifiedSegments(*this / data);
      REQUIRE(read);
      const SegmentSplit split = SplitSegments(read->set, kDefaultSplitSeed);
      model.training = {{"data_sha256", read->checksum}, {"split_seed", "1"}};
      model.learned_from = Union(FingerprintsOf(split.train), FingerprintsOf(split.validation));
    }
    REQUIRE(WriteWeightsFile(*this / name, model));
  }

  /// Without the oracle, which takes its time.
  Ended Evaluate(const std::string& flags, const std::string& data = "d",
                 const std::string& weights = "w") const {
    return Run(fmt::format("--data {} --weights {} --oracle-draws 0 {}", data, weights, flags));
  }
  Ended WithOracle(const std::string& flags) const {
    return Run("--data d --weights w --oracle-draws 2000 " + flags);
  }
  nlohmann::json Json(const char* name) const {
    return nlohmann::json::parse(*ReadFile(*this / name), nullptr, false);
  }
  SegmentSet set;
};

TEST_CASE("conav evaluate tests models on strangers, and continues from its cache", "[evaluate]") {
  const Bench bench;
  bench.Write("a.pb.zst", Synthetic(8));
  bench.Write("b.pb.zst", SegmentsOf(*std::make_unique<Glpf>(GlpfParameters{.rho = 0.1}), 8, 4, 5));
  const std::string run =
      "--train-on a.pb.zst,others --test-on a.pb.zst,b.pb.zst --curve 4 --width 16 --epochs 1 "
      "--trajectories 6 --people 1 --threads 1 --cache c ";
  const Ended first = bench.Run(run + "--json r --html h");
  INFO(first.text());
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.text(), Catch::Contains("strangers_no_worse_than_glpf"));
  CHECK_THAT(*ReadFile(bench / "h"), Catch::Contains("Reliability") && Catch::Contains("svg"));
  const auto json = bench.Json("r");
  for (const char* train : {"a", "others"}) {
    for (const char* test : {"a", "b"}) {
      const auto& cell = json["matrix"][train][test];
      CHECK(cell["nhpm_mbce"] > 0.0);
      CHECK(cell["glpf_mbce"] >= 0.99 * cell["glpf_test_mbce"].get<double>());
      CHECK(cell["nhpm_iou"].is_number());
      CHECK(cell["oracle_mbce"].is_null());  // of a population only
    }
  }
  // Those who are not a are b: a trained on a, b on the others, which are a.
  CHECK(json["matrix"]["a"]["b"]["nhpm_mbce"] == json["matrix"]["others"]["b"]["nhpm_mbce"]);
  CHECK(json["matrix"]["a"]["a"] != json["matrix"]["others"]["a"]);
  CHECK(json["curve"]["b"]["4"]["glpf_mbce"] > 0.0);
  CHECK(json["adaptation"]["b"]["people"] == 0);  // nobody has 100 segments and more
  REQUIRE(bench.Run(run + "--json again").exit_code == 0);
  CHECK(bench.Json("again") == json);
  const auto bars = json["bars"];
  const bool passed = bars["strangers_no_worse_than_glpf"]["passed"] == true &&
                      bars["pool_no_worse_than_glpf"]["passed"] == true;
  CHECK(bench.Run(run + "--check").exit_code == (passed ? 0 : 1));
  REQUIRE(bench.Run(run + "--view-encoding mask --json mask").exit_code == 0);
  CHECK(bench.Json("mask")["matrix"]["a"]["b"]["nhpm_mbce"] !=
        json["matrix"]["a"]["b"]["nhpm_mbce"]);
  CHECK(bench.Run("--train-on a.pb.zst").exit_code == 2);
  CHECK(bench.Run("--data d --train-on a.pb.zst --test-on a.pb.zst").exit_code == 2);
  CHECK(bench.Run("--train-on nowhere.yaml --test-on a.pb.zst").exit_code == 2);
  CHECK(bench.Run("--train-on a.pb.zst --test-on others").exit_code == 2);
  CHECK(bench.Run("--csv c --train-on a.pb.zst --test-on a.pb.zst").exit_code == 2);
}

TEST_CASE("conav evaluate prints table 1 and writes JSON, CSV and a page", "[evaluate]") {
  const Bench bench;
  const Ended ended = bench.WithOracle("--json r.json --csv r.csv --html r.html --segments 2,0");
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("synthetic data, d: test 1 trajectory") &&
                               Catch::Contains("split seed 1") && !Catch::Contains("warning"));
  const auto json = bench.Json("r.json");
  for (const char* key : {"glpf_train", "glpf_test", "nhpm", "oracle"}) {
    const double loss = json["models"][key]["mbce_all"];
    CHECK(loss > 0.0);
    CHECK_THAT(ended.text(), Catch::Contains(fmt::format("{:.5f}", loss)));
  }
  CHECK(json["bars"]["excess_share"]["passed"] == false);  // it learned nothing
  CHECK(json["models"]["nhpm"]["checksum"].get<std::string>().size() == 64);
  CHECK_THAT(*ReadFile(bench / "r.html"), Catch::StartsWith("<!DOCTYPE html>") &&
                                              Catch::Contains("Test segment 2: by request") &&
                                              !Catch::Contains("Test segment 1:"));
  CHECK_THAT(*ReadFile(bench / "r.csv"), Catch::Contains("\noracle,"));
  const Ended checked = bench.WithOracle("--check");
  CHECK(checked.exit_code == 1);
  CHECK_THAT(checked.text(), Catch::Contains("FAIL"));
}

TEST_CASE("Equal arguments give equal figures, on any number of threads", "[evaluate]") {
  const Bench bench(9);
  const Ended one = bench.WithOracle("--average-oracle --json - --threads 1");
  CHECK(one.exit_code == 0);
  CHECK(one.out == bench.WithOracle("--average-oracle --json - --threads 3").out);
  CHECK(nlohmann::json::parse(one.out, nullptr, false)["models"].contains("oracle_average"));
}

TEST_CASE("Each weights file, and each input that it saw, left out, has a row of its own",
          "[evaluate]") {
  const Bench bench;
  NetworkModel model = *ReadWeightsFile(bench / "w");
  model.inputs.path = false;
  REQUIRE(WriteWeightsFile(bench / "blind", model));
  const Ended ended = bench.Evaluate("--weights blind --without tau,o --json j");
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("blind: trained without tau"));
  const auto models = bench.Json("j")["models"];
  CHECK(models.size() == 7);
  CHECK(models["nhpm_without_tau"]["mbce_all"] != models["nhpm"]["mbce_all"]);
  CHECK(models["nhpm_without_tau"]["checksum"] != models["nhpm"]["checksum"]);
  CHECK_FALSE(models.contains("nhpm_2_without_tau"));
  CHECK(models.contains("nhpm_2_without_o"));
}

TEST_CASE("An encoder-decoder is compared with the other models on canvases", "[evaluate]") {
  const Bench bench;
  NetworkModel model = test::UntrainedEncoderDecoder(3);
  model.learned_from = {1};
  REQUIRE(WriteWeightsFile(bench / "rasters", model));
  const Ended ended = bench.Evaluate("--encoder-decoder rasters --json j");
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("synthetic data") && Catch::Contains("NHPM, scaled"));
  const auto json = bench.Json("j");
  CHECK(json["data"]["origin"] == "synthetic");
  const auto models = json["models"];
  for (const char* key : {"constant", "glpf_train", "glpf_test", "nhpm", "encoder_decoder"}) {
    CAPTURE(key);
    CHECK(models[key]["mbce_unmasked"].get<double>() > models[key]["mbce_all"].get<double>());
    CHECK(models[key]["true_edits_mean"] == models["constant"]["true_edits_mean"]);
  }
  CHECK(models["glpf_test"]["mbce_all"] < models["constant"]["mbce_all"]);
  CHECK(models["encoder_decoder"]["mbce_all"] > models["constant"]["mbce_all"]);  // untrained
  for (const char* wrong : {"--encoder-decoder w", "--weights rasters"}) {
    CHECK_THAT(bench.Evaluate(wrong).error, Catch::Contains("--encoder-decoder the other one"));
  }
  CHECK(bench.Evaluate("--encoder-decoder rasters --check").exit_code == 2);
}

TEST_CASE("People are no oracle, and their data is not called synthetic", "[evaluate]") {
  SegmentSet people = Synthetic(6);
  for (Trajectory& one : people.trajectories) one.origin = SegmentOrigin::kPerson;
  const Bench bench(people);
  const Ended ended = bench.WithOracle("--json j");
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("people data") && !Catch::Contains("FAIL"));
  CHECK_FALSE(bench.Json("j")["models"].contains("oracle"));
  CHECK(bench.Json("j")["bars"].empty());
  CHECK(bench.WithOracle("--check").exit_code == 2);
  CHECK(bench.WithOracle("--average-oracle").exit_code == 2);
}

TEST_CASE("A file's name need not be text", "[evaluate]") {
  const Bench bench;
  bench.Write("d\xff", bench.set);
  const Ended ended = bench.Evaluate("--json -", "d\xff");
  CHECK(ended.exit_code == 0);
  CHECK(nlohmann::json::parse(ended.out)["data"]["file"] == "d\uFFFD");
}

TEST_CASE("Data without a test part is refused, unless all of it is test", "[evaluate]") {
  const Bench bench(1);
  bench.WriteWeights("w", "");
  const Ended refused = bench.Evaluate("");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text(), Catch::Contains("d: nothing is left"));
  const Ended whole = bench.Evaluate("--all-test --json j");
  CHECK(whole.exit_code == 0);
  CHECK_THAT(whole.text(), Catch::Contains("the whole file is test"));
  CHECK_FALSE(bench.Json("j")["models"].contains("glpf_train"));
}

TEST_CASE(
    "Weights that saw some of a file are refused, whatever file they learned from, or allowed",
    "[evaluate]") {
  const Bench bench(12);
  SegmentSet other = bench.set;
  const char* advice = "pass data that it never saw";
  SECTION("their own") { advice = "--split-seed 1, or --allow-seen"; }
  SECTION("one that begins with the same trajectories") { other.trajectories.resize(6); }
  SECTION("one that they were merged into") {
    SegmentSet merged = Synthetic(2);
    for (Trajectory& trajectory : merged.trajectories) {
      trajectory.participant = "new";
      other.trajectories.push_back(trajectory);
    }
  }
  bench.Write("other", other);
  const Ended refused = bench.Evaluate("--all-test", "other");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text(), Catch::Contains("w: learned from ") && Catch::Contains(advice));
  const Ended allowed = bench.Evaluate("--all-test --allow-seen", "other");
  CHECK(allowed.exit_code == 0);
  CHECK_THAT(allowed.text(), Catch::Contains("warning: "));
}

TEST_CASE("Weights of other data are fine, those of nobody knows what give a warning",
          "[evaluate]") {
  const Bench bench;
  SegmentSet others = bench.set;
  for (Trajectory& trajectory : others.trajectories) trajectory.session = "another";
  bench.Write("other", others);
  bench.WriteWeights("a", "other");
  const Ended of_other = bench.Evaluate("", "d", "a");
  CHECK(of_other.exit_code == 0);
  CHECK_THAT(of_other.text(), !Catch::Contains("warning"));
  bench.WriteWeights("b", "");
  CHECK_THAT(bench.Evaluate("", "d", "b").text(), Catch::Contains("warning: b"));
}

TEST_CASE("Files that are not what they should be are named", "[evaluate]") {
  const Bench bench;
  bench.WriteWeights("large", "d", 13);
  SegmentSet anonymous = bench.set;
  for (Trajectory& trajectory : anonymous.trajectories) trajectory.annotator.clear();
  bench.Write("anonymous", anonymous);
  for (const auto& [files, names] : std::vector<std::pair<std::string, std::string>>{
           {"--data w --weights w", "w: "},
           {"--data d --weights d", "d: "},
           {"--data d --weights large", "13 x 13"},
           {"--data anonymous --weights w", "anonymous: test part: trajectory 0"}}) {
    const Ended ended = bench.Run(files + " --oracle-draws 2000");
    CHECK(ended.exit_code == 1);
    CHECK_THAT(ended.text(), Catch::Contains(names));
  }
  CHECK(bench.Evaluate("", "anonymous").exit_code == 0);  // without the oracle
}

TEST_CASE("Options that are out of range, contradict each other or go over an input are wrong use",
          "[evaluate]") {
  const Bench bench;
  for (const char* wrong :
       {"--without y", "--without tau,tau", "--oracle-draws 100", "--json - --csv -", "--threads 0",
        "--segments x", "--segments -1", "--split-seed -1", "--split-seed 1 --all-test",
        "--average-oracle --oracle-draws 0", "--average-oracle --all-test", "--json d", "--html w",
        "--csv r --html r"}) {
    INFO(wrong);
    CHECK(bench.Run("--data d --weights w " + std::string(wrong)).exit_code == 2);
  }
  const Ended ended = bench.Evaluate("--segments 400");
  CHECK(ended.exit_code == 2);
  CHECK_THAT(ended.text(), Catch::Contains("segments 0 to 3"));
  CHECK(ReadSegmentFile(bench / "d"));
  CHECK(ReadWeightsFile(bench / "w"));
}

}  // namespace
}  // namespace conav::nhpm
