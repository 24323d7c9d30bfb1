#include "common/segments/segment_checks.h"

#include <catch2/catch.hpp>
#include <limits>

#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What is said about the sample after `change`; empty when it passes.
template <class Change>
std::string Refusal(Change&& change) {
  Segment segment = tests::SampleSegment();
  change(segment);
  const auto checked = CheckSegment(segment);
  if (!checked) CHECK(checked.error().code == ErrorCode::kMalformed);
  return checked ? "" : checked.error().text;
}

TEST_CASE("the sample passes", "[segments]") {
  CHECK(Refusal([](Segment&) {}).empty());
  CHECK(CheckSegments(tests::SampleSet()));
  CHECK(CheckSegments({}));
}

TEST_CASE("maps of wrong size, shape or value are refused", "[segments]") {
  CHECK(Refusal([](Segment& s) { s.query.belief = BeliefGrid(); }) ==
        "x is 0 x 0; each side must be in [3, 1024]");
  CHECK(Refusal([](Segment& s) { s.query.belief = BeliefGrid(3, 1025); }) ==
        "x is 3 x 1025; each side must be in [3, 1024]");
  CHECK(Refusal([](Segment& s) { s.belief_after = BeliefGrid(5, 4); }) ==
        "x' is 5 x 4, but x is 4 x 5");
  CHECK(Refusal([](Segment& s) {
          s.query.belief[{1, 1}] = 0.5F;
        }) == "x is 0.5 at (1,1); it must be 0 or 1");
  CHECK(Refusal([](Segment& s) {
          s.belief_after[{1, 2}] = std::numeric_limits<float>::quiet_NaN();
        }) == "x' is nan at (1,2); it must be 0 or 1");
}

TEST_CASE("an edit on the border is refused", "[segments]") {
  CHECK(Refusal([](Segment& s) {
          s.belief_after[{3, 4}] = 0.0F;
        }) == "an edit at (3,4), on the border of the 4 x 5 map");
}

TEST_CASE("cells outside of the map are refused", "[segments]") {
  CHECK(Refusal([](Segment& s) {
          s.query.cell = {4, 0};
        }) == "camera cell (4,0) is outside of the 4 x 5 map");
  CHECK(Refusal([](Segment& s) {
          s.query.path.front() = {-1, 1};
        }) == "path cell (-1,1) is outside of the 4 x 5 map");
  CHECK(Refusal([](Segment& s) {
          s.query.visible.free.push_back({1, 5});
        }) == "seen free cell (1,5) is outside of the 4 x 5 map");
  CHECK(Refusal([](Segment& s) {
          s.query.visible.walls.push_back({9, 9});
        }) == "seen wall cell (9,9) is outside of the 4 x 5 map");
}

TEST_CASE("a path that is empty or ends elsewhere is refused", "[segments]") {
  CHECK(Refusal([](Segment& s) { s.query.path.clear(); }) == "the path is empty");
  CHECK(Refusal([](Segment& s) { s.query.path.pop_back(); }) ==
        "the path ends in (1,1), but the camera is in (1,2)");
}

TEST_CASE("seen cells out of order, repeated or contradicting are refused", "[segments]") {
  CHECK(Refusal([](Segment& s) {
          s.query.visible.free = {{1, 3}, {1, 2}};
        }) == "seen free cells are not sorted row-major without repeats: (1,3) before (1,2)");
  CHECK(Refusal([](Segment& s) {
          s.query.visible.walls = {{0, 2}, {0, 2}};
        }) == "seen wall cells are not sorted row-major without repeats: (0,2) before (0,2)");
  CHECK(Refusal([](Segment& s) {
          s.query.visible.walls = {{1, 3}};
        }) == "cell (1,3) is seen both free and as a wall");
}

TEST_CASE("numbers that are none and times out of order are refused", "[segments]") {
  CHECK(Refusal([](Segment& s) { s.query.heading_rad = kNan; }) ==
        "the heading is nan rad; it must be in [-1000000, 1000000]");
  CHECK(Refusal([](Segment& s) { s.query.heading_rad = -1e307; }) ==
        "the heading is -1e+307 rad; it must be in [-1000000, 1000000]");
  CHECK(Refusal([](Segment& s) { s.sent_s = kNan; }) ==
        "time 'sent' is nan s; it must be a number of at least 0");
  CHECK(Refusal([](Segment& s) { s.sent_s = -1.0; }) ==
        "time 'sent' is -1 s; it must be a number of at least 0");
  CHECK(Refusal([](Segment& s) { s.confirmed_s = 2.0; }) ==
        "time 'confirmed' is 2 s; it must be a number of at least 2.25");
}

TEST_CASE("a picture outside of the data set and a wrong checksum are refused", "[segments]") {
  CHECK(Refusal([](Segment& s) { s.image = "/etc/passwd"; }) ==
        "image '/etc/passwd' is not a file of the data set");
  CHECK(Refusal([](Segment& s) { s.image = "a/../../b.jpg"; }) ==
        "image 'a/../../b.jpg' is not a file of the data set");
  CHECK(Refusal([](Segment& s) { s.image_sha256 = "abc"; }) ==
        "image_sha256 'abc' is not 64 lower-case hexadecimal digits");
}

template <class Change>
std::string SetRefusal(Change&& change) {
  SegmentSet set = tests::SampleSet();
  change(set);
  const auto checked = CheckSegments(set);
  return checked ? "" : checked.error().text;
}

TEST_CASE("what is wrong with a set is named with trajectory and segment", "[segments]") {
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].segments[1].query.path.clear(); }) ==
        "trajectory 0, segment 1: the path is empty");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].segments[1].step = 2; }) ==
        "trajectory 0, segment 1: step 2 after step 2; steps rise");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[1].segments.clear(); }) ==
        "trajectory 1: it has no segments");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].truth = OccupancyGrid(5, 5); }) ==
        "trajectory 0, segment 0: x is 4 x 5, but the truth is 5 x 5");
  CHECK(SetRefusal([](SegmentSet& s) {
          Segment& segment = s.trajectories[1].segments.emplace_back(tests::SampleSegment());
          segment.query.belief = segment.belief_after = BeliefGrid(4, 6);
        }) == "trajectory 1, segment 1: x is 4 x 6, but the x of the segment before is 4 x 5");
}

TEST_CASE("facts of a trajectory that are no shares or no numbers are refused", "[segments]") {
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].final_cell_accuracy = 1.5; }) ==
        "trajectory 0: final cell accuracy is 1.5; it must be in [0, 1]");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].initial_cell_accuracy = kNan; }) ==
        "trajectory 0: initial cell accuracy is nan; it must be in [0, 1]");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[1].final_mapping_accuracy = -0.1; }) ==
        "trajectory 1: final mapping accuracy is -0.1; it must be in [0, 1]");
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].annotator["lapse"] = kNan; }) ==
        "trajectory 0: annotator's lapse is not a number");
}

TEST_CASE("names that are not UTF-8 are refused, all others pass", "[segments]") {
  for (const char* good : {"", "Zoë", "操作員", "\xF0\x9F\xA4\x96", "\xF4\x8F\xBF\xBF"}) {
    CHECK(SetRefusal([&](SegmentSet& s) { s.trajectories[0].session = good; }).empty());
  }
  for (const char* bad : {"\xFF", "\x80", "a\xC3", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80",
                          "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xC3(", "\xE2\x82"}) {
    CHECK(SetRefusal([&](SegmentSet& s) { s.trajectories[0].session = bad; }) ==
          "trajectory 0: the name of the session is not UTF-8");
  }
  CHECK(SetRefusal([](SegmentSet& s) { s.trajectories[0].annotator["\xFF"] = 1.0; }) ==
        "trajectory 0: the name of the annotator is not UTF-8");
  CHECK(Refusal([](Segment& s) { s.image = "\xFF"; }) == "the image's file name is not UTF-8");
}

}  // namespace
}  // namespace conav
