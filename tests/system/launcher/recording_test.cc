// A demo leaves its session as segments, for those who train perception models.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <set>

#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "support/program_runner.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

SegmentSet SegmentsOf(const DemoRun& demo) {
  const auto set = ReadSegmentFile(demo.RunFolder() / "segments.pb.zst");
  INFO(demo.Story());
  if (!set) FAIL(set.error().text);
  return *set;
}

bool IsBeside(Cell a, Cell b) {
  return std::abs(a.row - b.row) <= 1 && std::abs(a.column - b.column) <= 1;
}

/// Whether all edits are where the robot drove or looked, or one cell off: the simulated operator
/// misplaces walls and guesses.
bool EditsWereSeen(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  std::vector<Cell> seen = query.path;
  seen.insert(seen.end(), query.visible.free.begin(), query.visible.free.end());
  seen.insert(seen.end(), query.visible.walls.begin(), query.visible.walls.end());
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    if (query.belief.values()[i] == segment.belief_after.values()[i]) continue;
    const Cell edit = query.belief.CellAt(i);
    const auto beside = [&](Cell cell) { return IsBeside(edit, cell); };
    if (std::none_of(seen.begin(), seen.end(), beside)) return false;
  }
  return true;
}

/// What was recorded of seed 8, without the times.
SegmentSet SegmentsOfSeedEight() {
  DemoRun demo({"--headless", "--seed", "8", "--camera", "none"});
  demo.EndsWell();
  SegmentSet set = SegmentsOf(demo);
  for (Trajectory& trajectory : set.trajectories) {
    trajectory.session.clear();
    for (Segment& segment : trajectory.segments) {
      segment.sent_s = segment.first_edit_s = segment.confirmed_s = std::nullopt;
    }
  }
  return set;
}

}  // namespace

TEST_CASE("the same seed records the same segments", "[demo]") {
  const SegmentSet first = SegmentsOfSeedEight();
  CHECK(SegmentCount(first) > 0);
  CHECK(first == SegmentsOfSeedEight());
}

TEST_CASE("a demo leaves one segment for each picture", "[demo]") {
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none"});
  const nlohmann::json result = demo.EndsWell();
  const SegmentSet set = SegmentsOf(demo);
  REQUIRE(set.trajectories.size() == 1);
  const Trajectory& trajectory = set.trajectories[0];
  CHECK(trajectory.origin == SegmentOrigin::kSimulated);
  CHECK(trajectory.world == "conav13");
  CHECK(trajectory.world_seed == 7);
  CHECK(trajectory.session == demo.RunFolder().filename());
  CHECK(trajectory.truth.has_value());
  CHECK(trajectory.segments.size() == result["robots"][0]["pictures"]);
  CHECK(trajectory.initial_cell_accuracy == Approx(result["cell_accuracy_before"].get<double>()));
  const auto described = test::RunProgram(
      "conav-dataset",
      fmt::format("describe '{}'", (demo.RunFolder() / "segments.pb.zst").string()));
  CHECK(described.exit_code == 0);
  CHECK_FALSE(described.out.empty());
  int edited = 0;
  for (const Segment& segment : trajectory.segments) {
    if (EditCount(segment) == 0) continue;
    ++edited;
    CHECK(EditsWereSeen(segment));
  }
  CHECK(edited > 0);
}

TEST_CASE("each of two worlds is a trajectory of its own, with several robots", "[demo]") {
  DemoRun demo({"--headless", "--seed", "5", "--worlds", "2", "--robots", "2", "--camera", "none"});
  demo.EndsWell();
  const SegmentSet set = SegmentsOf(demo);
  std::set<std::uint64_t> seeds;
  for (const Trajectory& trajectory : set.trajectories) seeds.insert(trajectory.world_seed);
  CHECK(seeds == std::set<std::uint64_t>{5, 6});
  int edited = 0;
  int seen = 0;
  for (const Segment* segment : AllSegments(set)) {
    if (EditCount(*segment) == 0) continue;
    ++edited;
    seen += EditsWereSeen(*segment) ? 1 : 0;
  }
  // A wall that another robot ran into is marked meanwhile, once in a while.
  CHECK(edited > 0);
  CHECK(4 * seen >= 3 * edited);
}

TEST_CASE("recorded segments outlive a kill of the operator service", "[demo]") {
  // So slow that the session is far from its end when the first segment is there.
  DemoRun demo({"--headless", "--speed", "4", "--seed", "7", "--camera", "none"});
  const pid_t pid = demo.PidOf("operator");
  const auto recorded = [&] {
    const auto set = ReadSegmentFile(demo.RunFolder() / "segments.pb.zst");
    return set && SegmentCount(*set) > 0;
  };
  REQUIRE(testing::WaitUntil(recorded, std::chrono::seconds(100)));
  REQUIRE(::kill(pid, SIGKILL) == 0);
  CHECK(demo.Wait() != 0);
  CHECK(SegmentCount(SegmentsOf(demo)) > 0);
}

}  // namespace conav::testing
