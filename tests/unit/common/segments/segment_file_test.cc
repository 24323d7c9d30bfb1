#include "common/segments/segment_file.h"

#include <fmt/core.h>
#include <segments.pb.h>

#include <array>
#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_log.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

using test::TemporaryFolder;

/// The reason without the path before it; empty when the bytes are read.
std::string RefusalOf(const TemporaryFolder& folder, std::string_view bytes) {
  const auto path = folder.path() / "file";
  REQUIRE(WriteFile(path, bytes));
  const auto set = ReadSegmentFile(path);
  if (set) return "";
  CHECK(set.error().code == ErrorCode::kMalformed);
  const std::string prefix = path.string() + ": ";
  CHECK(set.error().text.starts_with(prefix));
  return set.error().text.substr(prefix.size());
}

std::string FrameOf(std::initializer_list<std::string> parts) {
  ZstdFrame frame;
  for (const std::string& part : parts) frame.Add(part);
  return frame.Finish();
}

SegmentLog OpenLog(const std::filesystem::path& path) {
  auto log = SegmentLog::Open(path);
  REQUIRE(log);
  return *std::move(log);
}

/// A recording of the sample trajectory.
void Record(const std::filesystem::path& path) {
  const Trajectory trajectory = tests::SampleTrajectory();
  SegmentLog log = OpenLog(path);
  for (const Segment& segment : trajectory.segments) REQUIRE(log.Append(0, trajectory, segment));
}

std::string Header() { return Delimited(HeaderRecord()); }
std::string SampleTrajectoryBytes() { return Delimited(ToRecord(tests::SampleTrajectory(), 0)); }

TEST_CASE("a written set is read with every field, also an empty one", "[segments]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "set.pb.zst";
  for (const SegmentSet& set : {tests::SampleSet(), SegmentSet()}) {
    REQUIRE(WriteSegmentFile(path, set));
    CHECK(ReadSegmentFile(path) == set);
  }
}

TEST_CASE("equal sets are equal files, byte by byte", "[segments]") {
  const TemporaryFolder folder;
  Trajectory forwards = tests::SampleTrajectory();
  Trajectory backwards = forwards;
  for (int i = 0; i < 50; ++i) {
    forwards.annotator[fmt::format("parameter {}", i)] = i;
    backwards.annotator[fmt::format("parameter {}", 49 - i)] = 49 - i;
  }
  REQUIRE(WriteSegmentFile(folder.path() / "a", {{forwards}}));
  REQUIRE(WriteSegmentFile(folder.path() / "b", {{backwards}}));
  CHECK(ReadFile(folder.path() / "a").value() == ReadFile(folder.path() / "b").value());
}

TEST_CASE("a set that does not pass the checks is not written, and what is not there not read",
          "[segments]") {
  const TemporaryFolder folder;
  SegmentSet set = tests::SampleSet();
  set.trajectories[0].segments[1].query.path.clear();
  test::CheckRefusal(WriteSegmentFile(folder / "set", set),
                     Catch::Contains("trajectory 0, segment 1"));
  CHECK(ReadSegmentFile(folder / "set").error().code == ErrorCode::kNotFound);
  CHECK(WriteSegmentFile("/dev/full", tests::SampleSet()).error().code == ErrorCode::kIo);
}

TEST_CASE("a file cut anywhere is refused as truncated, every flipped byte is noticed",
          "[segments]") {
  const TemporaryFolder folder;
  REQUIRE(WriteSegmentFile(folder / "set", tests::SampleSet()));
  const std::string whole = ReadFile(folder / "set").value();
  CHECK(RefusalOf(folder, "") == "it is empty");
  for (std::size_t size = 1; size < whole.size(); ++size) {
    CHECK_THAT(RefusalOf(folder, std::string_view(whole).substr(0, size)),
               Catch::StartsWith("it is truncated"));
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    // A frame header may say the same in two ways; what is read then is the same, too.
    REQUIRE(WriteFile(folder / "set", damaged));
    const auto read = ReadSegmentFile(folder / "set");
    CHECK((!read || *read == tests::SampleSet()));
  }
}

TEST_CASE("files of another kind, and records cut off or out of turn, are refused", "[segments]") {
  const TemporaryFolder folder;
  segments::Record later;
  later.mutable_header()->set_schema_version(2);
  for (const auto& [bytes, names] : std::vector<std::pair<std::string, std::string>>{
           {"{\"type\": \"trajectory\"}\n", "not compressed with zstd"},
           {FrameOf({Header()}) + "junk", "it is not zstd data"},
           {FrameOf({"hello, world, this is text"}), "record 0"},
           {FrameOf({}), "this is not a segment file"},
           {FrameOf({SampleTrajectoryBytes()}), "does not begin with a header"},
           {FrameOf({Header(), std::string(1, '\0')}), "neither header nor trajectory"},
           {FrameOf({Delimited(later)}), "schema version 2; this program reads 1"},
       }) {
    CHECK_THAT(RefusalOf(folder, bytes), Catch::Contains(names));
  }
  segments::Record no_origin = ToRecord(tests::SampleTrajectory(), 0);
  no_origin.mutable_trajectory()->set_origin(segments::ORIGIN_UNSPECIFIED);
  for (const auto& [record, names] : std::vector<std::pair<std::string, std::string>>{
           {"\xFF\xFF\xFF\x7F", "record 1 states a size of 268435455 bytes; 33554432"},
           {std::string(9, '\xFF'), "record 1 has no size"},
           {"dabc", "record 1 is cut off"},
           {"\x80", "record 1 is cut off"},
           {Delimited(no_origin), "trajectory 0: origin 0"},
           {Delimited(ToRecord(tests::SampleTrajectory(), 5)), "trajectory 5"},
           {SampleTrajectoryBytes(), "trajectory 0: it has no segments"},
       }) {
    CHECK_THAT(RefusalOf(folder, FrameOf({Header(), record})), Catch::StartsWith(names));
  }
}

TEST_CASE("whatever its records hold, a file is refused or is a set that passes all checks",
          "[segments]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "file";
  const std::string records = Header() + SampleTrajectoryBytes() +
                              Delimited(ToRecord(tests::SampleSegment(2), 0)) +
                              Delimited(ToRecord(tests::SampleSegment(3), 0));
  constexpr std::array kFlips{0x01, 0x08, 0x80, 0xFF, 0x02};
  int refused = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::string changed = records;
    changed[i] = static_cast<char>(changed[i] ^ kFlips[i % kFlips.size()]);
    REQUIRE(WriteFile(path, FrameOf({changed})));
    const auto read = ReadSegmentFile(path);
    refused += read ? 0 : 1;
    if (read) CHECK(CheckSegments(*read));
  }
  CHECK(refused > 0);
}

TEST_CASE("values and cells that no segment can have are refused with their place", "[segments]") {
  struct Row {
    std::string names;
    void (*change)(segments::Segment&);
  };
  using Message = segments::Segment;
  const TemporaryFolder folder;
  for (const Row& row : std::vector<Row>{
           {"x is 4000000000 x 5",
            [](Message& s) { s.mutable_map_before()->set_rows(4000000000U); }},
           {"x' has 20 values", [](Message& s) { s.mutable_map_after()->set_rows(1000); }},
           {"x is 2 at (1,1)",
            [](Message& s) { (*s.mutable_map_before()->mutable_cells())[6] = 2; }},
           {"seen free cell 20", [](Message& s) { s.add_free_cells(20); }},
       }) {
    segments::Record record = ToRecord(tests::SampleSegment(), 0);
    row.change(*record.mutable_segment());
    CHECK_THAT(RefusalOf(folder, FrameOf({Header(), SampleTrajectoryBytes(), Delimited(record)})),
               Catch::StartsWith("trajectory 0, segment 0: " + row.names));
  }
  const std::string stray = Delimited(ToRecord(tests::SampleSegment(), 1));
  CHECK_THAT(RefusalOf(folder, FrameOf({Header(), SampleTrajectoryBytes(), stray})),
             Catch::Contains("trajectory 1"));
}

TEST_CASE("a recording can be read at any time, holds the newest facts, goes on another day",
          "[segments]") {
  const TemporaryFolder folder;
  const auto path = folder / "log";
  Trajectory trajectory = tests::SampleTrajectory();
  {
    SegmentLog log = OpenLog(path);
    CHECK(ReadSegmentFile(path) == SegmentSet());
    REQUIRE(log.Append(0, trajectory, trajectory.segments[0]));
    trajectory.final_mapping_accuracy = 0.75;
    REQUIRE(log.Append(0, trajectory, trajectory.segments[1]));
    CHECK(ReadSegmentFile(path) == SegmentSet{{trajectory}});
  }
  SegmentLog log = OpenLog(path);
  REQUIRE(log.trajectories() == 1);
  Trajectory next = tests::SampleTrajectory();
  next.segments = {tests::SampleSegment(9)};
  REQUIRE(log.Append(1, next, next.segments[0]));
  CHECK(ReadSegmentFile(path) == SegmentSet{{trajectory, next}});
}

TEST_CASE("a recording cut off by a kill is refused, recovered on demand, and continued",
          "[segments]") {
  const TemporaryFolder folder;
  const auto path = folder / "log";
  Record(path);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 7);
  test::CheckRefusal(ReadSegmentFile(path), Catch::Contains("--recover"));
  const auto recovered = ReadSegmentFile(path, TornEnd::kDrop);
  REQUIRE(recovered);
  CHECK(recovered->trajectories.at(0).segments.size() == 1);
  const std::string torn = ReadFile(path).value();
  SegmentLog log = OpenLog(path);
  CHECK(ReadFile(path).value() + ReadFile(folder / "log.torn").value() == torn);
  const Trajectory next = tests::SampleTrajectory();
  REQUIRE(log.Append(1, next, next.segments[0]));
  const auto continued = ReadSegmentFile(path);
  REQUIRE(continued);
  CHECK(continued->trajectories.size() == 2);
}

TEST_CASE("the end set aside of one torn recording outlives the next", "[segments]") {
  const TemporaryFolder folder;
  REQUIRE(WriteFile(folder / "log.torn", "older"));
  const std::string frame = FrameOf({Header()});
  const std::string torn = frame.substr(0, 9);
  REQUIRE(WriteFile(folder / "log", frame + torn));
  REQUIRE(SegmentLog::Open(folder / "log"));
  CHECK(ReadFile(folder / "log") == frame);
  CHECK(ReadFile(folder / "log.torn") == "older" + torn);
}

/// Whether a recording of these bytes is refused as malformed; every byte is kept.
bool IsRefused(const TemporaryFolder& folder, const std::string& bytes) {
  REQUIRE(WriteFile(folder / "log", bytes));
  const auto log = SegmentLog::Open(folder / "log");
  if (!log) CHECK(log.error().code == ErrorCode::kMalformed);
  CHECK(ReadFile(folder / "log") == bytes);
  CHECK_FALSE(std::filesystem::exists(folder / "log.torn"));
  return !log;
}

TEST_CASE("a recording that is damaged amid its frames is refused and keeps every byte",
          "[segments]") {
  const TemporaryFolder folder;
  const Trajectory trajectory = tests::SampleTrajectory();
  std::vector<std::size_t> ends;
  {
    SegmentLog log = OpenLog(folder / "whole");
    for (std::uint32_t i = 0; i < 10; ++i) {
      REQUIRE(log.Append(0, trajectory, tests::SampleSegment(i)));
      ends.push_back(std::filesystem::file_size(folder / "whole"));
    }
  }
  const std::string whole = ReadFile(folder / "whole").value();
  const auto all = ReadSegmentFile(folder / "whole");
  REQUIRE(all);
  for (std::size_t bit = 8 * ends[1]; bit < 8 * ends[2]; ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    // A frame header may say the same in two ways; what is read then is the same, too.
    CHECK((IsRefused(folder, damaged) || ReadSegmentFile(folder / "log") == *all));
  }
  REQUIRE(WriteSegmentFile(folder / "set", tests::SampleSet()));
  std::string shorter = ReadFile(folder / "set").value();
  shorter.pop_back();
  CHECK(IsRefused(folder, shorter));
}

TEST_CASE("two programs do not record to one file, and no other file is recorded over",
          "[segments]") {
  const TemporaryFolder folder;
  const SegmentLog first = OpenLog(folder / "log");
  CHECK(SegmentLog::Open(folder / "log").error().code == ErrorCode::kUnavailable);
  REQUIRE(WriteFile(folder / "letter", "Dear Sir"));
  CHECK_FALSE(SegmentLog::Open(folder / "letter"));
  CHECK(ReadFile(folder / "letter") == "Dear Sir");
  CHECK_FALSE(SegmentLog::Open(folder / "no/such/folder"));
}

TEST_CASE("a recording takes no segment that its readers would refuse", "[segments]") {
  const TemporaryFolder folder;
  SegmentLog log = OpenLog(folder / "log");
  const Trajectory trajectory = tests::SampleTrajectory();
  REQUIRE(log.Append(0, trajectory, tests::SampleSegment(4)));
  CHECK_FALSE(log.Append(0, trajectory, tests::SampleSegment(4)));
  Segment bad = tests::SampleSegment(5);
  bad.belief_after[{0, 0}] = 0.0F;
  CHECK_FALSE(log.Append(0, trajectory, bad));
  CHECK(SegmentCount(ReadSegmentFile(folder / "log").value()) == 1);
}

}  // namespace
}  // namespace conav
