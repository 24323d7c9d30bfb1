// conav-dataset as a user meets it: files, messages, exit codes.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_json.h"
#include "common/segments/segment_split.h"
#include "support/program_runner.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

using Outcome = test::ProgramOutcome;

/// A folder with the sample as data.pb.zst, and the program run in it.
class Desk : public test::ProgramRunner {
 public:
  Desk() : ProgramRunner("conav-dataset") {
    REQUIRE(WriteSegmentFile(*this / "data.pb.zst", tests::SampleSet()));
  }
};

TEST_CASE("conav-dataset describes a file in words, numbers and a picture", "[nhpm][dataset]") {
  const Desk desk;
  const Outcome outcome = desk.Run("describe data.pb.zst --json data.json --svg data.svg");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Catch::StartsWith("SYNTHETIC") && Catch::Contains("segment 0 ("));
  CHECK(nlohmann::json::parse(ReadFile(desk / "data.json").value()).at("segments") == 3);
  CHECK_THAT(ReadFile(desk / "data.svg").value(),
             Catch::Contains("data.pb.zst: edits made by people+synthetic"));
}

TEST_CASE("numbers on standard output are nothing but JSON", "[nhpm][dataset]") {
  const Desk desk;
  const auto numbers = nlohmann::json::parse(desk.Run("describe data.pb.zst --json -").out);
  CHECK(numbers.at("edits") == 6);
  CHECK(numbers.at("segments_by_edits").at(2) == 3);
}

TEST_CASE("chosen segments are shown, a wrong number is wrong use", "[nhpm][dataset]") {
  const Desk desk;
  CHECK_THAT(desk.Run("describe data.pb.zst --segments 2,1").out,
             Catch::Contains("segment 2 (") && Catch::Contains("segment 1 (") &&
                 !Catch::Contains("segment 0 ("));
  const Outcome wrong = desk.Run("describe data.pb.zst --segments 7");
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.error == "conav dataset: there is no segment 7; the set has 3, from 0 on\n");
}

TEST_CASE("exported lines imported again are the same file", "[nhpm][dataset]") {
  const Desk desk;
  CHECK(desk.Run("export data.pb.zst --out data.jsonl").exit_code == 0);
  CHECK(desk.Run("import data.jsonl --out again.pb.zst").exit_code == 0);
  CHECK(ReadFile(desk / "data.pb.zst").value() == ReadFile(desk / "again.pb.zst").value());
  CHECK(desk.Run("export data.pb.zst").out == ReadFile(desk / "data.jsonl").value());
}

TEST_CASE("a bad line is refused with file and line, and nothing is written", "[nhpm][dataset]") {
  const Desk desk;
  REQUIRE(WriteFile(desk / "bad.jsonl", "\n{\"type\": \"segment\"}\n"));
  const Outcome outcome = desk.Run("import bad.jsonl --out bad.pb.zst");
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.error == "conav dataset: bad.jsonl:2: a segment before any trajectory\n");
  CHECK_FALSE(std::filesystem::exists(desk / "bad.pb.zst"));
}

TEST_CASE("files are merged, and a trajectory that comes twice is refused", "[nhpm][dataset]") {
  const Desk desk;
  REQUIRE(WriteSegmentFile(desk / "more.pb.zst", {{tests::SampleTrajectory(8)}}));
  CHECK(desk.Run("merge data.pb.zst more.pb.zst --out all.pb.zst").exit_code == 0);
  CHECK(ReadSegmentFile(desk / "all.pb.zst").value().trajectories.size() == 3);
  CHECK(desk.Run("merge data.pb.zst more.pb.zst --out all.pb.zst --min-mapping-accuracy 0.5")
            .exit_code == 0);
  CHECK(ReadSegmentFile(desk / "all.pb.zst").value().trajectories.size() == 2);
  const Outcome twice = desk.Run("merge data.pb.zst all.pb.zst --out twice.pb.zst");
  CHECK(twice.exit_code == 1);
  CHECK_THAT(twice.error,
             Catch::Contains("all.pb.zst: trajectory 0 is the same as data.pb.zst: trajectory 0"));
}

TEST_CASE("a split is three files with all trajectories", "[nhpm][dataset]") {
  const Desk desk;
  REQUIRE(WriteSegmentFile(desk / "many.pb.zst",
                           {{tests::SampleTrajectory(1), tests::SampleTrajectory(2),
                             tests::SampleTrajectory(3), tests::SampleTrajectory(4)}}));
  CHECK(desk.Run("split many.pb.zst --seed 3 --out-prefix part").exit_code == 0);
  CHECK(ReadSegmentFile(desk / "part-train.pb.zst").value().trajectories.size() == 2);
  CHECK(ReadSegmentFile(desk / "part-validation.pb.zst").value().trajectories.size() == 1);
  CHECK(ReadSegmentFile(desk / "part-test.pb.zst").value().trajectories.size() == 1);
}

TEST_CASE("a split without a seed is that of training and evaluation", "[nhpm][dataset]") {
  const Desk desk;
  SegmentSet many;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    many.trajectories.push_back(tests::SampleTrajectory(seed));
  }
  REQUIRE(WriteSegmentFile(desk / "many.pb.zst", many));
  CHECK(desk.Run("split many.pb.zst --out-prefix part").exit_code == 0);
  const SegmentSplit split = SplitSegments(many, kDefaultSplitSeed);
  CHECK(ReadSegmentFile(desk / "part-test.pb.zst").value() == split.test);
  CHECK(ReadSegmentFile(desk / "part-validation.pb.zst").value() == split.validation);
}

TEST_CASE("a truncated recording is refused unless it shall be recovered", "[nhpm][dataset]") {
  const Desk desk;
  std::string two = ReadFile(desk / "data.pb.zst").value();
  two += two.substr(0, two.size() / 2);
  REQUIRE(WriteFile(desk / "torn.pb.zst", two));
  const Outcome refused = desk.Run("describe torn.pb.zst");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.error,
             Catch::Contains("torn.pb.zst: it is truncated") && Catch::Contains("--recover"));
  CHECK(desk.Run("describe torn.pb.zst --recover").exit_code == 0);
}

TEST_CASE("no command writes over its input", "[nhpm][dataset]") {
  const Desk desk;
  const std::string before = ReadFile(desk / "data.pb.zst").value();
  REQUIRE(WriteFile(desk / "part-test.pb.zst", before));
  for (const char* command :
       {"import data.pb.zst --out data.pb.zst", "export data.pb.zst --out ./data.pb.zst",
        "merge data.pb.zst --out data.pb.zst", "describe data.pb.zst --json data.pb.zst",
        "describe data.pb.zst --svg x --json x", "split part-test.pb.zst --out-prefix part",
        "synthesize --trajectories 1 --out data.pb.zst --json data.pb.zst"}) {
    INFO(command);
    CHECK(desk.Run(command).exit_code == 2);
  }
  CHECK(ReadFile(desk / "data.pb.zst").value() == before);
  CHECK_FALSE(std::filesystem::exists(desk / "part-train.pb.zst"));
}

TEST_CASE("wrong use, missing files and a full disk have their exit codes", "[nhpm][dataset]") {
  const Desk desk;
  CHECK(desk.Run("").exit_code == 2);
  CHECK(desk.Run("describe").exit_code == 2);
  CHECK(desk.Run("improve data.pb.zst").exit_code == 2);
  CHECK_THAT(desk.Run("improve data.pb.zst").error, Catch::Contains("no command 'improve'"));
  CHECK(desk.Run("describe --help").exit_code == 0);
  CHECK_THAT(desk.Run("--help").out, Catch::Contains("Usage: conav dataset "));
  CHECK(desk.Run("synthesize --population none.yaml --out new.pb.zst").exit_code == 1);
  CHECK(desk.Run("split data.pb.zst --out-prefix part --seed -1").exit_code == 2);
  CHECK(desk.Run("describe none.pb.zst").exit_code == 1);
  CHECK(desk.Run("merge data.pb.zst --out /dev/full").exit_code == 1);
  CHECK(desk.Run("merge data.pb.zst --out none/data.pb.zst").exit_code == 2);
  CHECK(desk.Run("export data.pb.zst --out /dev/full").exit_code == 1);
  CHECK(desk.Run("describe data.pb.zst --json /dev/full").exit_code == 1);
  CHECK(desk.Run("describe data.pb.zst --svg none/data.svg").exit_code == 2);
}

}  // namespace
}  // namespace conav
