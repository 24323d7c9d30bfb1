#include <catch2/catch.hpp>
#include <sstream>

#include "common/runtime/file.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

std::string Exported(const SegmentSet& set) {
  std::ostringstream out;
  ExportSegments(set, out);
  return out.str();
}

Result<SegmentSet> Imported(const std::string& text) {
  std::istringstream in(text);
  return ImportSegments(in, "data.jsonl");
}

const std::string kTrajectory =
    R"({"type": "trajectory", "schema": 1, "origin": "person", "rows": 3, "columns": 3,)"
    R"( "initial_cell_accuracy": 0.5, "final_cell_accuracy": 1, "final_mapping_accuracy": 1})"
    "\n";
const std::string kSegment =
    R"({"type": "segment", "step": 0, "x": "111111111", "tau": [[1, 1]],)"
    R"( "pose": {"r": 1, "c": 1, "heading_deg": 45}, "o_free": "000010000",)"
    R"( "o_wall": "111000000", "x_next": "111101111"})"
    "\n";

std::string With(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// `place`: the line, and how its refusal begins.
void CheckRefused(const std::string& text, const std::string& place) {
  test::CheckRefusal(Imported(text), Catch::StartsWith("data.jsonl:" + place),
                     ErrorCode::kMalformed);
}

TEST_CASE("exported segments are imported bit by bit, and exported as the same text",
          "[segments]") {
  const std::string text = Exported(tests::SampleSet());
  const auto imported = Imported(text);
  REQUIRE(imported);
  CHECK(*imported == tests::SampleSet());
  CHECK(Exported(*imported) == text);
}

TEST_CASE("any heading survives its way through degrees, which are plain in eight directions",
          "[segments]") {
  CHECK_THAT(Exported(tests::SampleSet()), Catch::Contains(R"("heading_deg":45.0})"));
  std::vector<double> headings{0.0, -0.0, 5e-324, 1e-310, 2.2e-308, -1e-300, 1e-20, 999999.9, 1e6};
  for (int i = -100; i < 100; ++i) headings.push_back(0.0314159 * i);
  for (const double heading : headings) {
    SegmentSet set = tests::SampleSet();
    set.trajectories[1].segments[0].query.heading_rad = heading;
    CHECK(Imported(Exported(set)) == set);
  }
}

TEST_CASE("lines need only what nobody else can know", "[segments]") {
  const auto set = Imported("\n" + kTrajectory + "  \r\n" + kSegment);
  REQUIRE(set);
  REQUIRE(set->trajectories.size() == 1);
  CHECK(set->trajectories[0].origin == SegmentOrigin::kPerson);
  CHECK_FALSE(set->trajectories[0].truth);
  const Segment& segment = set->trajectories[0].segments.at(0);
  CHECK(EditCount(segment) == 1);
  CHECK(segment.belief_after[{1, 1}] == 0.0F);
  CHECK(segment.query.visible.walls == std::vector<Cell>{{0, 0}, {0, 1}, {0, 2}});
  CHECK_FALSE(segment.sent_s);
  CHECK(Imported("") == SegmentSet());
  // Where nobody knows the truth the accuracies may be null.
  const auto nulls =
      Imported(With(kTrajectory, "\"final_mapping_accuracy\": 1",
                    "\"truth\": null, \"valid\": null, \"final_mapping_accuracy\": null") +
               kSegment);
  REQUIRE(nulls);
  CHECK(nulls->trajectories[0].final_mapping_accuracy == 0.0);
}

TEST_CASE("lines are refused with file, line and what is wrong with them", "[segments]") {
  for (const auto& [text, place] : std::vector<std::pair<std::string, std::string>>{
           {"hello", "1: this is not JSON: byte 1, after 'h'"},
           {kTrajectory + kSegment + "{\"type\": \"seg", "3: this is not JSON: byte 14"},
           {"[1e999]", "1: this is not JSON: "},
           {"[1]", "1: the line"},
           {"{}", "1: 'type'"},
           {R"({"type": "header"})", "1: 'type' is 'header'"},
           {kSegment, "1: a segment before"},
           {kTrajectory + kTrajectory + kSegment, "2: the previous trajectory"},
           {kTrajectory + kSegment + kSegment, "3: step 0 after step 0"},
       }) {
    CheckRefused(text, place);
  }
  struct Change {
    std::string from, to, place;
  };
  const std::string rows = "\"rows\": 3";
  const std::string x = "\"x\": \"111111111\"";
  for (const Change& change : std::vector<Change>{
           {"\"schema\": 1", "\"schema\": 2", "1: schema 2"},
           {"person", "martian", "1: 'origin' is 'martian'"},
           {rows, "\"rows\": 100000000", "1: 'rows' is 100000000"},
           {rows, "\"rows\": -3", "1: 'rows' is -3"},
           {rows, "\"truth\": \"1\", \"rows\": 3", "1: 'truth' has 1 bits for 9"},
           {rows, "\"rwos\": 3, \"rows\": 3", "1: 'rwos'"},
           {"0.5", "NaN", "1: this is not JSON: byte "},
           {"0.5", "null, \"truth\": \"111101111\"", "1: 'initial_cell_accuracy'"},
           {"0.5", "1.5", "1: initial cell accuracy is 1.5"},
           {rows, "\"valid\": false, \"rows\": 3", "1: 'valid' is false"},
           {rows, "\"edits\": 4, \"rows\": 3", "2: the previous trajectory has 1 edits"},
           {rows, "\"annotator\": {\"a\": \"x\"}, \"rows\": 3", "1: 'annotator.a' is \"x\""},
           {x, "\"x\": \"11111111\"", "2: 'x' has 8 bits for 9"},
           {x, "\"x\": \"111121111\"", "2: 'x' has a '2' at 4"},
           {x + ", ", "", "2: 'x' is missing"},
           {"111101111", "011101111", "2: an edit at (0,0)"},
           {"[[1, 1]]", "[[1, -1]]", "2: 'tau' has -1"},
           {"[[1, 1]]", "[1, 1]", "2: 'tau' has 1"},
           {"45", "\"north\"", "2: 'pose.heading_deg' is \"north\""},
           {"45", "45, \"heading_rad\": 3.0", "2: pose: heading_rad 3"},
           {"\"step\": 0", "\"step\": 4294967296", "2: 'step' is 4294967296"},
       }) {
    CheckRefused(With(kTrajectory + kSegment, change.from, change.to), change.place);
  }
}

TEST_CASE("whatever the lines hold, they are refused or are a set that passes all checks",
          "[segments]") {
  const std::string text = Exported(tests::SampleSet());
  int refused = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char other : {'9', '"', '-', '\n', '\xff'}) {
      std::string changed = text;
      changed[i] = other;
      const auto set = Imported(changed);
      refused += set ? 0 : 1;
      if (set) CHECK(CheckSegments(*set));
    }
  }
  CHECK(refused > 0);
}

TEST_CASE("files of JSON lines are read and written", "[segments]") {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "set.jsonl";
  REQUIRE(ExportSegmentsFile(path, tests::SampleSet()));
  CHECK(ImportSegmentsFile(path) == tests::SampleSet());
  CHECK(ImportSegmentsFile(folder.path() / "none").error().code == ErrorCode::kNotFound);
  REQUIRE(WriteSegmentFile(folder.path() / "set.pb.zst", tests::SampleSet()));
  CHECK_THAT(ImportSegmentsFile(folder.path() / "set.pb.zst").error().text,
             Catch::Contains("like a segment file, which needs no import"));
}

}  // namespace
}  // namespace conav
