#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "common/grid/map_accuracy.h"
#include "common/grid/visibility.h"
#include "common/segments/segment_checks.h"
#include "nhpm/dataset/synthesize.h"
#include "sim/world/maze_presets.h"

namespace conav::nhpm {
namespace {

Trajectory Run(std::uint64_t seed, int extra_pictures = 8) {
  Annotator annotator;
  annotator.extra_pictures = extra_pictures;
  auto trajectory = RunMappingTask({}, annotator, seed);
  REQUIRE(trajectory.has_value());
  return *std::move(trajectory);
}

bool Free(const Trajectory& trajectory, Cell cell) {
  return (*trajectory.truth)[cell] == Occupancy::kFree;
}

TEST_CASE(
    "A trajectory has a picture of each goal and then the extra ones, passes every check and "
    "says where it is from",
    "[synthesis]") {
  for (const int extra : {0, 1, 9}) {
    const Trajectory trajectory = Run(5, extra);
    REQUIRE(trajectory.segments.size() == 4U + static_cast<unsigned>(extra));
    for (std::uint32_t i = 0; i < trajectory.segments.size(); ++i) {
      CHECK(trajectory.segments[i].step == i);
      CHECK(trajectory.segments[i].goals_reached == std::min(i + 1, 4U));
    }
    CHECK(CheckSegments({{trajectory}}));
    CHECK(trajectory.origin == SegmentOrigin::kSynthetic);
    CHECK(trajectory.world == "conav13");
    CHECK(trajectory.annotator == ToNamedValues({}));
  }
}

TEST_CASE(
    "The robot drives through free cells, one after the other, from picture to picture, and the "
    "map goes with it",
    "[synthesis]") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Trajectory trajectory = Run(seed);
    const Segment* before = nullptr;
    for (const Segment& segment : trajectory.segments) {
      if (before != nullptr) {
        CHECK(segment.query.belief == before->belief_after);
        CHECK(segment.query.path.front() == before->query.cell);
      }
      before = &segment;
      const std::vector<Cell>& path = segment.query.path;
      CHECK(path.size() >= 2);
      CHECK(path.back() == segment.query.cell);
      for (std::size_t i = 0; i < path.size(); ++i) {
        CHECK(Free(trajectory, path[i]));
        if (i > 0) CHECK(AreNeighbours(path[i - 1], path[i]));
      }
      CHECK(std::set<Cell>(path.begin(), path.end()).size() == path.size());
    }
  }
}

TEST_CASE("A picture shows the true maze through the lens of the simulated camera", "[synthesis]") {
  const Trajectory trajectory = Run(2);
  std::set<double> headings;
  for (const Segment& segment : Run(2, 40).segments) {
    const PerceptionQuery& query = segment.query;
    headings.insert(query.heading_rad);
    CHECK(query.visible ==
          CastView(*trajectory.truth, ViewThrough(CameraLens{}, query.cell, query.heading_rad, 2)));
  }
  std::set<double> eight;
  for (int i = 0; i < 8; ++i) eight.insert(HeadingFromIndex(i, 8));
  CHECK(headings == eight);
}

TEST_CASE("The map is wrong at first by the corruption, and its accuracies are what it ends with",
          "[synthesis]") {
  const Trajectory trajectory = Run(3);
  const BeliefGrid truth = ToBelief(*trajectory.truth);
  const BeliefGrid& before = trajectory.segments.front().query.belief;
  const BeliefGrid& after = trajectory.segments.back().belief_after;
  int wrong_before = 0;
  int wrong_after = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    wrong_before += before.values()[i] != truth.values()[i];
    wrong_after += after.values()[i] != truth.values()[i];
  }
  CHECK(wrong_before == 20);  // round(0.12 * 13 * 13)
  CHECK(trajectory.initial_cell_accuracy == Approx(1.0 - 20.0 / 121.0));
  CHECK(trajectory.final_cell_accuracy == Approx(1.0 - wrong_after / 121.0));
  CHECK(trajectory.final_mapping_accuracy == Approx(std::max(0.0, (20.0 - wrong_after) / 20.0)));
}

TEST_CASE("After the goals the robot prefers places where the map is wrong", "[synthesis]") {
  MappingTaskOptions indifferent;
  indifferent.tour.background = 1e9;
  MappingTaskOptions attracted;
  attracted.tour.background = 0.0;
  const auto wrong_around = [](const MappingTaskOptions& options) {
    Annotator asleep;
    asleep.reader.lapse_probability = 1.0;
    asleep.extra_pictures = 100;
    double near = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto trajectory = RunMappingTask(options, asleep, seed);
      REQUIRE(trajectory.has_value());
      const BeliefGrid truth = ToBelief(*trajectory->truth);
      for (const Segment& segment : trajectory->segments) {
        if (segment.step < 4) continue;
        for (std::size_t i = 0; i < truth.size(); ++i) {
          const Cell way = truth.CellAt(i) - segment.query.cell;
          near += way.row * way.row + way.column * way.column <= 9 &&
                  truth.values()[i] != segment.query.belief.values()[i];
        }
      }
    }
    return near / 500.0;
  };
  CHECK(wrong_around(attracted) > 1.15 * wrong_around(indifferent));
}

TEST_CASE("The same maze mapped by another person begins the same", "[synthesis]") {
  Annotator asleep;
  asleep.reader.lapse_probability = 1.0;
  const auto slept = RunMappingTask({}, asleep, 7);
  REQUIRE(slept.has_value());
  CHECK(slept->truth == Run(7).truth);
  CHECK(slept->segments.front().query == Run(7).segments.front().query);
  for (const Segment& segment : slept->segments) CHECK(EditCount(segment) == 0);
  CHECK(slept->final_mapping_accuracy == 0.0);
}

TEST_CASE("Every maze preset can be mapped", "[synthesis]") {
  for (const sim::MazePreset& preset : sim::MazePresets()) {
    CAPTURE(preset.name);
    const auto trajectory = RunMappingTask({.preset = preset.name}, {}, 1);
    REQUIRE(trajectory.has_value());
    CHECK(trajectory->truth->rows() == preset.options.height);
    CHECK(trajectory->segments.back().goals_reached == static_cast<unsigned>(preset.goals));
  }
}

}  // namespace
}  // namespace conav::nhpm
