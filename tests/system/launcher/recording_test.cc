// A demo leaves its session as segments, for those who train perception models.
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <set>

#include "common/segments/segment_file.h"
#include "common/segments/segment_labels.h"
#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;

namespace {

/// What describes the session, without the times.
conav::SegmentSet WithoutTimes(conav::SegmentSet set) {
  for (conav::Trajectory& trajectory : set.trajectories) {
    trajectory.session.clear();
    for (conav::Segment& segment : trajectory.segments) {
      segment.sent_s.reset();
      segment.first_edit_s.reset();
      segment.confirmed_s.reset();
    }
  }
  return set;
}

conav::SegmentSet SegmentsOf(const DemoRun& demo) {
  const auto set = conav::ReadSegmentFile(demo.RunFolder() / "segments.pb.zst");
  INFO(demo.Story());
  if (!set) FAIL(set.error().text);
  return *set;
}

/// Whether a cell was changed to what the picture shows.
bool EditsWereSeen(const conav::Segment& segment) {
  const conav::EditLabels labels = conav::LabelsOf(segment);
  for (const conav::Cell cell : segment.query.visible.free) {
    if (labels.remove[cell] != 0) return true;
  }
  for (const conav::Cell cell : segment.query.visible.walls) {
    if (labels.add[cell] != 0) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a demo leaves one segment for each picture", "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none"});
  REQUIRE(demo.Wait() == 0);
  const conav::SegmentSet set = SegmentsOf(demo);
  const nlohmann::json result = demo.Json();
  REQUIRE(set.trajectories.size() == 1);
  const conav::Trajectory& trajectory = set.trajectories[0];
  CHECK(trajectory.origin == conav::SegmentOrigin::kSimulated);
  CHECK(trajectory.world == "conav13");
  CHECK(trajectory.world_seed == 7);
  CHECK(trajectory.session == demo.RunFolder().filename());
  CHECK(trajectory.truth.has_value());
  CHECK(trajectory.segments.size() == result["robots"][0]["pictures"]);
  CHECK(trajectory.initial_cell_accuracy == Approx(result["cell_accuracy_before"].get<double>()));
  int edited = 0;
  for (const conav::Segment& segment : trajectory.segments) {
    if (conav::EditCount(segment) == 0) continue;
    ++edited;
    CHECK(EditsWereSeen(segment));
  }
  CHECK(edited > 0);
}

TEST_CASE("the same seed records the same segments", "[launcher][system]") {
  const std::vector<std::string> arguments{"--headless", "--seed", "8", "--camera", "none"};
  DemoRun first(arguments);
  REQUIRE(first.Wait() == 0);
  DemoRun second(arguments);
  REQUIRE(second.Wait() == 0);
  const conav::SegmentSet segments = WithoutTimes(SegmentsOf(first));
  CHECK(conav::SegmentCount(segments) > 0);
  CHECK(segments == WithoutTimes(SegmentsOf(second)));
}

TEST_CASE("each of two worlds is a trajectory of its own, with several robots",
          "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "5", "--worlds", "2", "--robots", "2", "--camera", "none"});
  REQUIRE(demo.Wait() == 0);
  const conav::SegmentSet set = SegmentsOf(demo);
  std::set<std::uint64_t> seeds;
  for (const conav::Trajectory& trajectory : set.trajectories) seeds.insert(trajectory.world_seed);
  CHECK(seeds == std::set<std::uint64_t>{5, 6});
  for (const conav::Segment* segment : conav::AllSegments(set)) {
    if (conav::EditCount(*segment) > 0) CHECK(EditsWereSeen(*segment));
  }
}

TEST_CASE("conav dataset describes the recording of a demo", "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none"});
  REQUIRE(demo.Wait() == 0);
  const std::string file = (demo.RunFolder() / "segments.pb.zst").string();
  const std::string command = fmt::format(
      "'{}/conav-dataset' describe '{}' --json '{}.json' >/dev/null", CONAV_BIN_DIR, file, file);
  CHECK(WEXITSTATUS(std::system(command.c_str())) == 0);
  CHECK(std::filesystem::file_size(file + ".json") > 0);
}

TEST_CASE("what was recorded outlives a kill of the operator service", "[launcher][system]") {
  // So slow that the session is far from its end when the first segment is there.
  DemoRun demo({"--headless", "--speed", "4", "--seed", "7", "--camera", "none"});
  const pid_t pid = demo.PidOf("operator");
  const auto recorded = [&] {
    const auto set = conav::ReadSegmentFile(demo.RunFolder() / "segments.pb.zst");
    return set && conav::SegmentCount(*set) > 0;
  };
  REQUIRE(conav::testing::WaitUntil(recorded, std::chrono::seconds(100)));
  REQUIRE(::kill(pid, SIGKILL) == 0);
  CHECK(demo.Wait() != 0);
  CHECK(conav::SegmentCount(SegmentsOf(demo)) > 0);
}
