#include "nhpm/evaluation/glpf_statistics.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "nhpm/evaluation/metrics.h"

namespace conav::nhpm {
namespace {

int SquaredDistance(Cell a, Cell b) {
  const Cell offset = a - b;
  return offset.row * offset.row + offset.column * offset.column;
}

void CountSegment(const Segment& segment, GlpfStatistics& statistics) {
  const PerceptionQuery& query = segment.query;
  const std::set<Cell> walls(query.visible.walls.begin(), query.visible.walls.end());
  const std::set<Cell> free(query.visible.free.begin(), query.visible.free.end());
  const std::set<Cell> path(query.path.begin(), query.path.end());
  const BeliefGrid& before = query.belief;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Cell cell = before.CellAt(i);
    if (before.OnBorder(cell)) continue;
    const bool is_wall = before.values()[i] >= 0.5F;
    const bool seen_wrong = is_wall ? free.contains(cell) : walls.contains(cell);
    const int distance = SquaredDistance(cell, query.cell);
    StimulusCount& count = seen_wrong                       ? statistics.seen[distance]
                           : is_wall && path.contains(cell) ? statistics.on_path[distance]
                                                            : statistics.unstimulated;
    count.outputs += 1.0;
    count.edits += is_wall != (segment.belief_after.values()[i] >= 0.5F) ? 1.0 : 0.0;
  }
}

double LossOf(const StimulusCount& count, double probability) {
  return count.edits * CrossEntropy(probability, true) +
         (count.outputs - count.edits) * CrossEntropy(probability, false);
}

}  // namespace

double GlpfStatistics::outputs() const {
  double sum = unstimulated.outputs;
  for (const auto& [distance, count] : seen) sum += count.outputs;
  for (const auto& [distance, count] : on_path) sum += count.outputs;
  return sum;
}

GlpfStatistics CountStimuli(std::span<const Segment* const> segments) {
  GlpfStatistics statistics;
  for (const Segment* segment : segments) CountSegment(*segment, statistics);
  return statistics;
}

double GlpfLoss(const GlpfStatistics& statistics, const GlpfParameters& parameters) {
  const double outputs = statistics.outputs();
  if (outputs == 0.0) return 0.0;
  const Glpf model(parameters);
  const auto response_at = [&](int squared_distance) {
    return model.Response(model.Stimulus(std::sqrt(static_cast<double>(squared_distance))));
  };
  double sum = LossOf(statistics.unstimulated, model.Response(0.0));
  for (const auto& [distance, count] : statistics.seen) sum += LossOf(count, response_at(distance));
  for (const auto& [distance, count] : statistics.on_path) {
    sum += LossOf(count, parameters.visible_only ? model.Response(0.0) : response_at(distance));
  }
  return sum / outputs;
}

}  // namespace conav::nhpm
