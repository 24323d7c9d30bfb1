#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/synthesize.h"
#include "support/program_runner.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav::nhpm {
namespace {

using Outcome = test::ProgramOutcome;

/// A folder with the sample as data.pb.zst, and the program run in it.
class DatasetBench : public test::ProgramRunner {
 public:
  DatasetBench() : ProgramRunner("conav-dataset") {
    REQUIRE(WriteSegmentFile(*this / "data.pb.zst", tests::SampleSet()));
  }
};

TEST_CASE("conav-dataset describes a file in words, numbers and a picture, '-' is nothing but JSON",
          "[dataset]") {
  const DatasetBench bench;
  const Outcome outcome = bench.Run("describe data.pb.zst --json data.json --svg data.svg");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Catch::StartsWith("SYNTHETIC") && Catch::Contains("segment 0 ("));
  CHECK(nlohmann::json::parse(ReadFile(bench / "data.json").value()).at("segments") == 3);
  CHECK_THAT(ReadFile(bench / "data.svg").value(),
             Catch::Contains("data.pb.zst: edits made by people+synthetic"));
  const auto numbers = nlohmann::json::parse(bench.Run("describe data.pb.zst --json -").out);
  CHECK(numbers.at("edits") == 6);
  CHECK(numbers.at("segments_by_edits").at(2) == 3);
  CHECK_THAT(bench.Run("describe data.pb.zst --segments 2,1").out,
             Catch::Contains("segment 2 (") && Catch::Contains("segment 1 (") &&
                 !Catch::Contains("segment 0 ("));
  const Outcome wrong = bench.Run("describe data.pb.zst --segments 7");
  CHECK(wrong.exit_code == 2);
  CHECK_THAT(wrong.error, Catch::Contains("segment 7"));
}

TEST_CASE("exported lines imported again are the same file, a bad line is refused by its place",
          "[dataset]") {
  const DatasetBench bench;
  CHECK(bench.Run("export data.pb.zst --out data.jsonl").exit_code == 0);
  CHECK(bench.Run("import data.jsonl --out again.pb.zst").exit_code == 0);
  CHECK(ReadFile(bench / "data.pb.zst").value() == ReadFile(bench / "again.pb.zst").value());
  CHECK(bench.Run("export data.pb.zst").out == ReadFile(bench / "data.jsonl").value());
  REQUIRE(WriteFile(bench / "bad.jsonl", "\n{\"type\": \"segment\"}\n"));
  const Outcome refused = bench.Run("import bad.jsonl --out bad.pb.zst");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.error, Catch::Contains("bad.jsonl:2: "));
  REQUIRE(WriteFile(bench / "empty.jsonl", "\n"));
  const Outcome empty = bench.Run("import empty.jsonl --out bad.pb.zst");
  CHECK(empty.exit_code == 1);
  CHECK_THAT(empty.error, Catch::Contains("empty.jsonl: has no trajectories"));
  CHECK_FALSE(std::filesystem::exists(bench / "bad.pb.zst"));
}

TEST_CASE("files are merged, and a trajectory that comes twice is refused", "[dataset]") {
  const DatasetBench bench;
  REQUIRE(WriteSegmentFile(bench / "more.pb.zst", {{tests::SampleTrajectory(8)}}));
  CHECK(bench.Run("merge data.pb.zst more.pb.zst --out all.pb.zst").exit_code == 0);
  CHECK(ReadSegmentFile(bench / "all.pb.zst").value().trajectories.size() == 3);
  CHECK(bench.Run("merge data.pb.zst more.pb.zst --out all.pb.zst --min-mapping-accuracy 0.5")
            .exit_code == 0);
  CHECK(ReadSegmentFile(bench / "all.pb.zst").value().trajectories.size() == 2);
  const Outcome twice = bench.Run("merge data.pb.zst all.pb.zst --out twice.pb.zst");
  CHECK(twice.exit_code == 1);
  CHECK_THAT(twice.error, Catch::Contains("all.pb.zst: trajectory 0"));
}

TEST_CASE("a split is three files, without a seed it is that of training and evaluation",
          "[dataset]") {
  const DatasetBench bench;
  SegmentSet many;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    many.trajectories.push_back(tests::SampleTrajectory(seed));
  }
  REQUIRE(WriteSegmentFile(bench / "many.pb.zst", many));
  CHECK(bench.Run("split many.pb.zst --out-prefix part").exit_code == 0);
  const SegmentSplit split = SplitSegments(many, kDefaultSplitSeed);
  CHECK(ReadSegmentFile(bench / "part-test.pb.zst").value() == split.test);
  CHECK(ReadSegmentFile(bench / "part-validation.pb.zst").value() == split.validation);
  CHECK(ReadSegmentFile(bench / "part-train.pb.zst").value() == split.train);
  CHECK(bench.Run("split many.pb.zst --out-prefix other --seed 3").exit_code == 0);
  CHECK(ReadSegmentFile(bench / "other-test.pb.zst").value() == SplitSegments(many, 3).test);
}

TEST_CASE("a truncated recording is refused, and read with --recover", "[dataset]") {
  const DatasetBench bench;
  std::string two = ReadFile(bench / "data.pb.zst").value();
  two += two.substr(0, two.size() / 2);
  REQUIRE(WriteFile(bench / "torn.pb.zst", two));
  const Outcome refused = bench.Run("describe torn.pb.zst");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.error,
             Catch::Contains("torn.pb.zst: it is truncated") && Catch::Contains("--recover"));
  CHECK(bench.Run("describe torn.pb.zst --recover").exit_code == 0);
}

TEST_CASE("wrong use ends with 2, and no command writes over its input", "[dataset]") {
  const DatasetBench bench;
  const std::string before = ReadFile(bench / "data.pb.zst").value();
  REQUIRE(WriteFile(bench / "part-test.pb.zst", before));
  for (const char* command :
       {"import data.pb.zst --out data.pb.zst", "export data.pb.zst --out ./data.pb.zst",
        "merge data.pb.zst --out data.pb.zst",
        "merge data.pb.zst --out set --min-mapping-accuracy nan",
        "describe data.pb.zst --json data.pb.zst", "describe data.pb.zst --svg x --json x",
        "split part-test.pb.zst --out-prefix part",
        "synthesize --trajectories 1 --out data.pb.zst --json data.pb.zst",
        "synthesize --out set --trajectories 0", "synthesize --out set --seed -1",
        "synthesize --out set --threads 0", "synthesize --out set --per-person 0",
        "synthesize --out set --preset 9x8", "improve data.pb.zst"}) {
    INFO(command);
    CHECK(bench.Run(command).exit_code == 2);
  }
  CHECK(ReadFile(bench / "data.pb.zst").value() == before);
  CHECK_FALSE(std::filesystem::exists(bench / "part-train.pb.zst"));
  CHECK_FALSE(std::filesystem::exists(bench / "set"));
}

TEST_CASE(
    "The file holds the trajectories of the library, in folders that may be new, the summary "
    "counts them",
    "[synthesis]") {
  const DatasetBench bench;
  const Outcome outcome = bench.Run(
      "synthesize --trajectories 7 --seed 5 --preset 9x9 --per-person 2 --threads 2 "
      "--out very/new/set --json summary");
  REQUIRE(outcome.exit_code == 0);
  SynthesisOptions options;
  options.trajectories = 7;
  options.seed = 5;
  options.task.preset = "9x9";
  options.trajectories_per_person = 2;
  const Synthesis expected = SynthesizeSegments(options).value();
  CHECK(ReadSegmentFile(bench / "very/new/set").value() == expected.set);
  const auto summary = nlohmann::json::parse(ReadFile(bench / "summary").value());
  CHECK(summary["origin"] == "synthetic");
  CHECK(summary["accepted"] == 7);
  CHECK(summary["segments"] == SegmentCount(expected.set));
  CHECK(summary["excluded"] == expected.excluded);
  CHECK(summary["excluded_share"] == Approx(expected.excluded / (expected.excluded + 7.0)));
}

TEST_CASE("Waves of mazes that other processes kept give the same file", "[synthesis]") {
  const DatasetBench bench;
  const std::string command = "synthesize --trajectories 70 --preset 9x9 --records kept --out ";
  REQUIRE(bench.Run("synthesize --trajectories 70 --preset 9x9 --out whole").exit_code == 0);
  REQUIRE(bench.Run(command + "set --piece 1").exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(bench / "set"));
  const auto kept = std::filesystem::last_write_time(bench / "kept/pieces/1.pb.zst");
  REQUIRE(bench.Run(command + "set").exit_code == 0);
  CHECK(std::filesystem::last_write_time(bench / "kept/pieces/1.pb.zst") == kept);
  CHECK((ReadFile(bench / "set").value() == ReadFile(bench / "whole").value()));
  CHECK(bench.Run(command + "set --seed 2").exit_code == 1);  // another command's records
}

TEST_CASE("Another population makes other people, one that all fail the filter none",
          "[synthesis]") {
  const DatasetBench bench;
  const auto synthesize = [&](const std::string& careful) {
    REQUIRE(WriteFile(
        bench / "people.yaml",
        "annotators: {ros__parameters: {careless_share: 0.0, careful: {" + careful + "}}}"));
    return bench.Run("synthesize --trajectories 3 --population people.yaml --out set").exit_code;
  };
  CHECK(synthesize("cautious: {}") == 1);
  CHECK(synthesize("lapse_probability: {mean: 1.0, deviation: 0.0}") == 1);
  CHECK_FALSE(std::filesystem::exists(bench / "set"));
  REQUIRE(synthesize("near_cells: {mean: 1.5}") == 0);
  const SegmentSet set = ReadSegmentFile(bench / "set").value();
  for (const Trajectory& trajectory : set.trajectories) {
    CHECK(trajectory.annotator.at("near_cells") == 1.5);
  }
}

}  // namespace
}  // namespace conav::nhpm
