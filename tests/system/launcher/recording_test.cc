// What a demo leaves: its session as segments, for those who train perception models, and its
// decisions.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "planner/explain/decision_file.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

SegmentSet SegmentsOf(const DemoRun& demo) {
  const auto set = ReadSegmentFile(demo.RunFolder() / "segments.pb.zst");
  INFO(demo.Story());
  if (!set) FAIL(set.error().text);
  return *set;
}

std::ptrdiff_t CountEdited(const SegmentSet& set) {
  return std::ranges::count_if(AllSegments(set),
                               [](const Segment* segment) { return EditCount(*segment) > 0; });
}

TEST_CASE("each of two worlds is a trajectory of its own, with several robots", "[demo]") {
  DemoRun demo("--headless --seed 5 --worlds 2 --robots 2 --camera none");
  demo.EndsWell();
  const SegmentSet set = SegmentsOf(demo);
  std::set<std::uint64_t> seeds;
  for (const Trajectory& trajectory : set.trajectories) seeds.insert(trajectory.world_seed);
  CHECK(seeds == std::set<std::uint64_t>{5, 6});
  CHECK(CountEdited(set) > 0);
}

using planner::DecisionRecord;

std::vector<DecisionRecord> DecisionsOf(const DemoRun& demo) {
  std::vector<DecisionRecord> decisions;
  const auto torn = planner::ReadDecisions(
      demo.RunFolder() / "decisions.pb.zst",
      [&](DecisionRecord&& decision) { decisions.push_back(std::move(decision)); });
  INFO(demo.Story());
  if (!torn) FAIL(torn.error().text);
  CHECK_FALSE(*torn);
  return decisions;
}

/// What was recorded of a seed, without the times.
std::pair<SegmentSet, std::vector<DecisionRecord>> RecordedOfSeedEight() {
  DemoRun demo("--headless --seed 8 --camera none --perception embedded");
  demo.EndsWell();
  SegmentSet set = SegmentsOf(demo);
  for (Trajectory& trajectory : set.trajectories) {
    trajectory.session.clear();
    for (Segment& segment : trajectory.segments) {
      segment.sent_s = segment.first_edit_s = segment.confirmed_s = std::nullopt;
    }
  }
  auto decisions = DecisionsOf(demo);
  for (DecisionRecord& decision : decisions) decision.report.duration_ms = 0.0;
  return {set, decisions};
}

TEST_CASE("the same seed records the same segments and decisions", "[demo]") {
  const auto first = RecordedOfSeedEight();
  CHECK(SegmentCount(first.first) > 0);
  CHECK_FALSE(first.second.empty());
  CHECK(first == RecordedOfSeedEight());
}

TEST_CASE("a demo's decisions are recorded with what explains them", "[demo]") {
  DemoRun demo("--headless --seed 7 --camera none");
  const auto result = demo.EndsWell();
  const auto decisions = DecisionsOf(demo);
  CHECK(decisions.size() == result.at("robots").at(0).at("decisions"));
  const auto snapshot =
      std::find_if(decisions.begin(), decisions.end(),
                   [](const DecisionRecord& decision) { return decision.sends_snapshot(); });
  REQUIRE(snapshot != decisions.end());
  CHECK(snapshot->report.has_terms);
  CHECK_FALSE(snapshot->report.tree.empty());
  CHECK_FALSE(snapshot->report.views.empty());
}

}  // namespace
}  // namespace conav::testing
