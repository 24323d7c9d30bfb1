#include "common/segments/segment_checks.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/refusal.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

/// What makes the sample wrong, and what its refusal names.
template <class Value>
struct Rejection {
  std::string names;
  void (*change)(Value&);
};

TEST_CASE("a mistake in a set is named with trajectory and segment, the sample passes",
          "[segments]") {
  CHECK(CheckSegment(tests::SampleSegment()));
  CHECK(CheckSegments(tests::SampleSet()));
  CHECK(CheckSegments({}));
  const std::vector<Rejection<SegmentSet>> rows{
      {"trajectory 0, segment 1: the path",
       [](SegmentSet& s) { s.trajectories[0].segments[1].query.path.clear(); }},
      {"trajectory 0, segment 1: step 2",
       [](SegmentSet& s) { s.trajectories[0].segments[1].step = 2; }},
      {"trajectory 1: it has no", [](SegmentSet& s) { s.trajectories[1].segments.clear(); }},
      {"trajectory 0, segment 0: x is 4 x 5",
       [](SegmentSet& s) { s.trajectories[0].truth = OccupancyGrid(5, 5); }},
      {"trajectory 1, segment 1: x is 4 x 6",
       [](SegmentSet& s) {
         Segment& segment = s.trajectories[1].segments.emplace_back(tests::SampleSegment());
         segment.query.belief = segment.belief_after = BeliefGrid(4, 6);
       }},
      {"trajectory 0: final cell",
       [](SegmentSet& s) { s.trajectories[0].final_cell_accuracy = 1.5; }},
      {"trajectory 0: initial cell",
       [](SegmentSet& s) { s.trajectories[0].initial_cell_accuracy = NAN; }},
      {"trajectory 1: final mapping",
       [](SegmentSet& s) { s.trajectories[1].final_mapping_accuracy = -0.1; }},
      {"trajectory 0: annotator's lapse",
       [](SegmentSet& s) { s.trajectories[0].annotator["lapse"] = NAN; }},
      {"name of the session", [](SegmentSet& s) { s.trajectories[0].session.push_back('\xFF'); }},
      {"name of the annotator", [](SegmentSet& s) { s.trajectories[0].annotator["\xFF"] = 1.0; }},
  };
  for (const auto& row : rows) {
    SegmentSet set = tests::SampleSet();
    row.change(set);
    test::CheckRefusal(CheckSegments(set), Catch::Contains(row.names));
  }
}

TEST_CASE("what no segment can be is refused by name", "[segments]") {
  for (const auto& row : std::vector<Rejection<Segment>>{
           // maps of wrong size, shape or value, edits on the border
           {"x is 0 x 0", [](Segment& s) { s.query.belief = BeliefGrid(); }},
           {"x is 3 x 1025", [](Segment& s) { s.query.belief = BeliefGrid(3, 1025); }},
           {"x' is 5 x 4", [](Segment& s) { s.belief_after = BeliefGrid(5, 4); }},
           {"x is 0.5 at (1,1)", [](Segment& s) { s.query.belief.values()[6] = 0.5F; }},
           {"x' is nan at (1,2)", [](Segment& s) { s.belief_after.values()[7] = NAN; }},
           {"an edit at (3,4)", [](Segment& s) { s.belief_after.values()[19] = 0.0F; }},
           // cells outside of the map, paths that end elsewhere
           {"camera cell (4,2)", [](Segment& s) { s.query.cell.row = 4; }},
           {"path cell (-1,1)", [](Segment& s) { s.query.path.front().row = -1; }},
           {"seen free cell (1,5)", [](Segment& s) { s.query.visible.free[1].column = 5; }},
           {"seen wall cell (9,4)", [](Segment& s) { s.query.visible.walls[2].row = 9; }},
           {"the path is empty", [](Segment& s) { s.query.path.clear(); }},
           {"the path ends in (1,1)", [](Segment& s) { s.query.path.pop_back(); }},
           // seen cells out of order, repeated or contradicting
           {"(1,3) before (1,2)", [](Segment& s) { std::ranges::reverse(s.query.visible.free); }},
           {"(0,2) before (0,2)", [](Segment& s) { s.query.visible.walls[1].column = 2; }},
           {"cell (1,3)",
            [](Segment& s) {
              s.query.visible.walls.push_back({1, 3});
            }},
           // numbers that are none, times out of order, foreign images
           {"heading is nan", [](Segment& s) { s.query.heading_rad = NAN; }},
           {"heading is -1e+307", [](Segment& s) { s.query.heading_rad = -1e307; }},
           {"'sent' is nan", [](Segment& s) { s.sent_s = NAN; }},
           {"'sent' is -1", [](Segment& s) { s.sent_s = -1.0; }},
           {"'confirmed' is 2", [](Segment& s) { s.confirmed_s = 2.0; }},
           {"'/etc/passwd'", [](Segment& s) { s.image = "/etc/passwd"; }},
           {"'a/../../b.jpg'", [](Segment& s) { s.image = "a/../../b.jpg"; }},
           {"image_sha256 'abc'", [](Segment& s) { s.image_sha256 = "abc"; }},
           {"file name is not UTF-8", [](Segment& s) { s.image.back() = '\xFF'; }},
       }) {
    Segment segment = tests::SampleSegment();
    row.change(segment);
    test::CheckRefusal(CheckSegment(segment), Catch::Contains(row.names), ErrorCode::kMalformed);
  }
}

}  // namespace
}  // namespace conav
