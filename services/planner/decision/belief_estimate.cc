#include "planner/decision/belief_estimate.h"

#include <algorithm>

#include "common/runtime/demand.h"

namespace conav::planner {
namespace {

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
  if (!belief_) belief_ = published;
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
  Advance(*belief_, answers->front());
  return {};
}

}  // namespace conav::planner
