#pragma once

#include <string>

#include "common/segments/segment.h"
#include "support/drawn_map.h"

/// Segments with no field at its default, for round trips and refusals.
namespace conav::tests {

/// On a 4 x 5 map: from (1,1) to (1,2), looking north-east; (1,3) was a wall, (2,1) becomes one.
inline Segment SampleSegment(std::uint32_t step = 2) {
  Segment segment;
  segment.step = step;
  segment.query.belief = DrawnMap({"#####", "#  ##", "#   #", "#####"});
  segment.belief_after = DrawnMap({"#####", "#   #", "##  #", "#####"});
  segment.query.path = {{1, 1}, {1, 2}};
  segment.query.cell = {1, 2};
  segment.query.heading_rad = 0.7853981633974483;
  segment.query.visible = {{{1, 2}, {1, 3}}, {{0, 2}, {0, 3}, {0, 4}}};
  segment.image = "images/0002.jpg";
  segment.image_sha256 = std::string(64, 'a');
  segment.sent_s = 1.5;
  segment.first_edit_s = 2.25;
  segment.confirmed_s = 3.125;
  segment.goals_reached = 1;
  return segment;
}

inline Trajectory SampleTrajectory(std::uint64_t seed = 7) {
  Trajectory trajectory;
  trajectory.origin = SegmentOrigin::kSynthetic;
  trajectory.participant = "p07";
  trajectory.session = "s1";
  trajectory.world = "conav13";
  trajectory.world_seed = seed;
  trajectory.corruption_seed = 18446744073709551615ULL;
  trajectory.truth = OccupancyGrid(4, 5, Occupancy::kOccupied);
  (*trajectory.truth)[{1, 1}] = Occupancy::kFree;
  (*trajectory.truth)[{2, 2}] = Occupancy::kUnknown;
  trajectory.initial_cell_accuracy = 0.875;
  trajectory.final_cell_accuracy = 0.9375;
  trajectory.final_mapping_accuracy = 0.6;
  trajectory.annotator = {{"decay", 0.125}, {"lapse", 0.02}};
  trajectory.annotator_seed = 99;
  trajectory.segments = {SampleSegment(2), SampleSegment(3)};
  return trajectory;
}

/// One whole trajectory and one of a person of whom little is known.
inline SegmentSet SampleSet() {
  Trajectory bare;
  bare.segments = {SampleSegment(0)};
  bare.segments[0].image.clear();
  bare.segments[0].image_sha256.clear();
  bare.segments[0].sent_s.reset();
  bare.segments[0].first_edit_s.reset();
  bare.segments[0].confirmed_s.reset();
  bare.segments[0].query.heading_rad = -2.0123456789;
  return {{SampleTrajectory(), bare}};
}

}  // namespace conav::tests
