#include "planner/decision/operator_reliability.h"

#include <algorithm>

#include "common/grid/map_accuracy.h"

namespace conav::planner {
namespace {

bool IsRight(float wall_probability, Occupancy known) {
  return (wall_probability >= kWallThreshold) == (known == Occupancy::kOccupied);
}

}  // namespace

void OperatorReliability::Heard(const BeliefGrid& belief, const OccupancyGrid& known) {
  if (belief_) Compare(belief, known);
  belief_ = belief;
  expected_edits_.reset();
}

void OperatorReliability::Compare(const BeliefGrid& belief, const OccupancyGrid& known) {
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Occupancy cell = known.values()[i];
    if (cell == Occupancy::kUnknown) continue;
    const bool was_right = IsRight(belief_->values()[i], cell);
    shown_ += IsRight(belief.values()[i], cell) - was_right;
    if (was_right || !expected_edits_) continue;
    expected_ += expected_edits_->add.values()[i] + expected_edits_->remove.values()[i];
  }
  shown_ = std::clamp(shown_, -prior_edits_, expected_);
  if (expected_ <= kMemoryEdits) return;
  shown_ *= kMemoryEdits / expected_;
  expected_ = kMemoryEdits;
}

}  // namespace conav::planner
