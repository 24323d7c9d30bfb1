#include "planner/methods/operator_model.h"

#include <algorithm>

#include "common/grid/map_accuracy.h"
#include "common/runtime/result.h"

namespace conav::planner {
namespace {

bool IsRight(float wall_probability, Occupancy known) {
  return (wall_probability >= kWallThreshold) == (known == Occupancy::kOccupied);
}

}  // namespace

void OperatorReliability::Received(const BeliefGrid& belief, const OccupancyGrid& known,
                                   double cell_size_m) {
  if (belief_) Compare(belief, known, cell_size_m);
  belief_ = belief;
  expected_edits_.reset();
}

void OperatorReliability::Compare(const BeliefGrid& belief, const OccupancyGrid& known,
                                  double cell_size_m) {
  const double side = EditSide(cell_size_m);
  const double edit = 1.0 / (side * side);
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Occupancy cell = known.values()[i];
    if (cell == Occupancy::kUnknown) continue;
    const bool was_right = IsRight(belief_->values()[i], cell);
    shown_ += edit * (IsRight(belief.values()[i], cell) - was_right);
    if (was_right || !expected_edits_) continue;
    expected_ += edit * static_cast<double>(expected_edits_->add.values()[i] +
                                            expected_edits_->remove.values()[i]);
  }
  shown_ = std::clamp(shown_, -prior_edits_, expected_);
  if (expected_ <= kMemoryEdits) return;
  shown_ *= kMemoryEdits / expected_;
  expected_ = kMemoryEdits;
}

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
  if (belief_ && SameSize(*belief_, published)) return *belief_;
  belief_ = published;
  if (starts_unknown_) std::ranges::fill(belief_->values(), 0.5F);
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

namespace {

std::vector<float> BeliefOf(const std::vector<Cell>& cells, const BeliefGrid& belief) {
  std::vector<float> values;
  values.reserve(cells.size());
  for (const Cell cell : cells) values.push_back(belief[cell]);
  return values;
}

}  // namespace

void SentViews::Sent(const View& view, VisibleCells visible) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.view == view; });
  Entry entry{view, std::move(visible.free), {}};
  entry.cells.insert(entry.cells.end(), visible.walls.begin(), visible.walls.end());
  entries_.push_back(std::move(entry));
}

void SentViews::Update(const BeliefGrid& belief) {
  std::erase_if(entries_, [&](Entry& entry) {
    std::vector<float> now = BeliefOf(entry.cells, belief);
    if (entry.belief.empty()) {
      entry.belief = std::move(now);
      return false;
    }
    return now != entry.belief;
  });
}

std::vector<SentViews::View> SentViews::Withheld() const {
  std::vector<View> views;
  for (const Entry& entry : entries_) views.push_back(entry.view);
  return views;
}

}  // namespace conav::planner
