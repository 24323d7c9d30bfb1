#pragma once

#include <vector>

#include "common/runtime/random.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/metrics.h"

namespace conav::nhpm {

/// rows x columns, border walls, free inside, camera in the middle looking east, nothing edited.
inline Segment EmptySegment(int rows = 5, int columns = 5) {
  Segment segment;
  BeliefGrid map(rows, columns, 0.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.OnBorder(map.CellAt(i))) map.values()[i] = 1.0F;
  }
  segment.query.belief = map;
  segment.query.cell = {rows / 2, columns / 2};
  segment.query.path = {segment.query.cell};
  segment.query.visible.free = {segment.query.cell};
  segment.belief_after = map;
  return segment;
}

inline PerceptionAnswer ZeroAnswer(const Segment& segment) {
  const BeliefGrid& map = segment.query.belief;
  return {Grid<float>(map.rows(), map.columns()), Grid<float>(map.rows(), map.columns())};
}

inline std::vector<const Segment*> Pointers(const std::vector<Segment>& segments) {
  std::vector<const Segment*> pointers;
  for (const Segment& segment : segments) pointers.push_back(&segment);
  return pointers;
}

inline void Flip(Segment& segment, Cell cell) {
  segment.belief_after[cell] = 1.0F - segment.query.belief[cell];
}

/// Outcomes of segments with the same number of unmasked outputs each; half of all are masked.
inline Outcomes MakeOutcomes(const std::vector<std::vector<Outcome>>& segments) {
  Outcomes outcomes;
  for (const auto& segment : segments) {
    outcomes.values.insert(outcomes.values.end(), segment.begin(), segment.end());
    outcomes.segment_ends.push_back(outcomes.values.size());
    outcomes.outputs += 2 * segment.size();
  }
  return outcomes;
}

/// A map of random walls, a path of two cells and a picture of a random part of it.
inline Segment RandomSegment(Random& random, int size = 13) {
  Segment segment = EmptySegment(size, size);
  PerceptionQuery& query = segment.query;
  query.cell = {static_cast<int>(random.Uniform(1, size - 2)),
                static_cast<int>(random.Uniform(1, size - 3))};
  query.path = {{query.cell.row, query.cell.column + 1}, query.cell};
  query.visible = {};
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    const Cell cell = query.belief.CellAt(i);
    if (query.belief.OnBorder(cell)) continue;
    query.belief.values()[i] = random.Chance(0.3) ? 1.0F : 0.0F;
    const bool shown = random.Chance(0.4);
    const bool is_wall = random.Chance(0.3);
    if (shown) (is_wall ? query.visible.walls : query.visible.free).push_back(cell);
  }
  segment.belief_after = query.belief;
  return segment;
}

}  // namespace conav::nhpm
