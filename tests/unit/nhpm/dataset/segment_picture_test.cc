#include <algorithm>
#include <catch2/catch.hpp>

#include "nhpm/dataset/set_summary.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav::nhpm {
namespace {

TEST_CASE("a segment in characters shows path, view, edits and heading", "[dataset]") {
  SegmentSet set = tests::SampleSet();
  CHECK(SegmentText(ChooseSegments(set, 1).at(0)) ==
        "segment 0 (trajectory 0, step 2, synthetic): 2 edits\n"
        "  before  shown   after\n"
        "  #####     ###   #####\n"
        "  #o^##     ..    #  -#\n"
        "  #   #           #+  #\n"
        "  #####           #####\n");
  const auto drawn = [&](double heading_rad) {
    set.trajectories[0].segments[0].query.heading_rad = heading_rad;
    return SegmentText(ChooseSegments(set, 1).at(0));
  };
  CHECK_THAT(drawn(0.1), Catch::Contains("#o>##"));
  CHECK_THAT(drawn(3.1), Catch::Contains("#o<##"));
  CHECK_THAT(drawn(-1.5), Catch::Contains("#ov##"));
  CHECK_THAT(drawn(-3.1), Catch::Contains("#o<##"));
}

TEST_CASE("segments with edits are preferred, others fill up", "[dataset]") {
  SegmentSet set;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    set.trajectories.push_back(tests::SampleTrajectory(seed));  // of two segments
  }
  const auto leave_edits_in = [&](const std::vector<std::size_t>& indices) {
    for (std::size_t i = 0; i < 10; ++i) {
      Segment& segment = set.trajectories[i / 2].segments[i % 2];
      if (std::ranges::find(indices, i) == indices.end()) {
        segment.belief_after = segment.query.belief;
      }
    }
  };
  const auto indices = [&](std::size_t count) {
    std::vector<std::size_t> chosen;
    for (const ChosenSegment& one : ChooseSegments(set, count)) chosen.push_back(one.index);
    return chosen;
  };
  using Indices = std::vector<std::size_t>;
  CHECK(indices(3) == Indices{0, 3, 6});
  leave_edits_in({1, 4, 5});
  CHECK(indices(1) == Indices{1});
  CHECK(indices(2) == Indices{1, 4});
  CHECK(indices(5) == Indices{0, 1, 4, 5, 6});
  CHECK(indices(20).size() == 10);
  CHECK(ChooseSegments(SegmentSet(), 5).empty());
}

TEST_CASE("the picture has three maps for each segment and marks each edit", "[dataset]") {
  const SegmentSet set = tests::SampleSet();
  const std::string svg = SegmentsSvg(ChooseSegments(set, 2), "a < b");
  CHECK(test::CountOf(svg, "width=\"17.0\" height=\"17.0\"") == 2 * (3 * 20 + 5));
  CHECK(test::CountOf(svg, "<circle") == 2 + 1);  // removed walls and the legend
  CHECK(test::CountOf(svg, "stroke=\"#D55E00\"") ==
        6);  // crosses of two lines: added walls, legend
  CHECK_THAT(svg, Catch::Contains("a &lt; b") && Catch::Contains("synthetic: 2 edits"));
  CHECK(test::XmlError(svg) == "");
}

}  // namespace
}  // namespace conav::nhpm
