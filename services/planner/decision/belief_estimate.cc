#include "planner/decision/belief_estimate.h"

#include <algorithm>

#include "common/runtime/demand.h"

namespace conav::planner {
namespace {

bool SameSize(const BeliefGrid& a, const BeliefGrid& b) {
  return a.rows() == b.rows() && a.columns() == b.columns();
}

void Advance(BeliefGrid& belief, const PerceptionAnswer& answer) {
  // The answer's probabilities hold "and there is a wall" (or none) already: they are masked by x.
  for (std::size_t i = 0; i < belief.size(); ++i) {
    float& x = belief.values()[i];
    x = std::clamp(x + answer.add.values()[i] - answer.remove.values()[i], 0.0F, 1.0F);
  }
}

}  // namespace

BeliefGrid BeliefEstimate::Now(const BeliefGrid& published) {
  const std::lock_guard lock(mutex_);
  if (!belief_ || !SameSize(*belief_, published)) belief_ = published;
  return *belief_;
}

Result<void> BeliefEstimate::NoteSent(std::vector<Cell> path, Cell cell, double heading_rad,
                                      VisibleCells visible) {
  PerceptionQuery query{.path = std::move(path),
                        .cell = cell,
                        .heading_rad = heading_rad,
                        .visible = std::move(visible)};
  {
    const std::lock_guard lock(mutex_);
    DEMAND(belief_.has_value());
    query.belief = *belief_;
  }
  const auto answers = model_->Predict({&query, 1});
  if (!answers) return tl::unexpected(answers.error());
  const std::lock_guard lock(mutex_);
  // Meanwhile another robot may have begun a new estimate.
  if (SameSize(*belief_, answers->front().add)) Advance(*belief_, answers->front());
  return {};
}

}  // namespace conav::planner
