#include "planner/search/grid_steps.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>

#include "common/grid/map_accuracy.h"

namespace conav::planner {
namespace {

constexpr int kNoWay = std::numeric_limits<int>::max() / 2;

std::size_t At(int index) { return static_cast<std::size_t>(index); }

/// As GridGraph: the outermost ring holds walls.
bool MayBeFree(const OccupancyGrid& known, Cell cell) {
  return known[cell] == Occupancy::kFree ||
         (known[cell] == Occupancy::kUnknown && !known.OnBorder(cell));
}

bool IsBelievedWall(const BeliefGrid& belief, std::size_t index) {
  return belief.values()[index] >= kWallThreshold;
}

/// Elements of one of two sorted ranges.
template <class T>
std::vector<T> Differences(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<T> different;
  std::ranges::set_symmetric_difference(a, b, std::back_inserter(different));
  return different;
}

}  // namespace

void GridSteps::Update(const OccupancyGrid& known, const std::vector<Cell>& occupied,
                       std::vector<VertexId> goals, StepCounts counts) {
  std::sort(goals.begin(), goals.end());
  const std::vector<int> other_goals = Differences(goals_, goals);
  goals_ = std::move(goals);
  if (known_.rows() != known.rows() || known_.columns() != known.columns()) {
    known_ = known;
    counts_ = {};
    Begin();
  }
  std::vector<int> changed = ChangedCells(known, occupied);
  TakeCounts(std::move(counts), changed);
  for (const int goal : other_goals) Renew(goal);
  for (const int cell : changed) {
    Renew(cell);
    RenewAround(cell);
  }
}

/// And takes them over.
std::vector<int> GridSteps::ChangedCells(const OccupancyGrid& known,
                                         const std::vector<Cell>& occupied) {
  std::vector<int> changed;
  for (const Cell cell : Differences(occupied_, occupied)) {
    if (known.Contains(cell)) changed.push_back(static_cast<int>(known.IndexOf(cell)));
  }
  occupied_ = occupied;
  const auto before = known_.values();
  const auto now = known.values();
  for (auto at = now.begin(); at != now.end();) {
    const auto from = before.begin() + (at - now.begin());
    at = std::mismatch(at, now.end(), from).first;
    if (at == now.end()) break;
    changed.push_back(static_cast<int>(at - now.begin()));
    before[At(changed.back())] = *at++;
  }
  return changed;
}

/// And adds the cells where steps count otherwise than before.
void GridSteps::TakeCounts(StepCounts counts, std::vector<int>& changed) {
  if (counts.off_guidance == 1) counts.guidance.clear();
  if (counts.believed_wall == 1) counts.belief.reset();
  std::ranges::sort(counts.guidance);
  std::swap(counts_, counts);
  const StepCounts& before = counts;
  const bool is_other_rule = counts_.believed_wall != before.believed_wall ||
                             counts_.off_guidance != before.off_guidance ||
                             counts_.guidance.empty() != before.guidance.empty();
  if (is_other_rule) return Begin();
  for (const Cell cell : Differences(counts_.guidance, before.guidance)) {
    if (known_.Contains(cell)) changed.push_back(static_cast<int>(known_.IndexOf(cell)));
  }
  if (counts_.belief == before.belief) return;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (IsBelievedWall(*counts_.belief, i) != IsBelievedWall(*before.belief, i)) {
      changed.push_back(static_cast<int>(i));
    }
  }
}

void GridSteps::Begin() {
  steps_.assign(known_.size(), kNoWay);
  next_.assign(known_.size(), kNoWay);
  open_.clear();
  for (const int goal : goals_) Renew(goal);
}

double GridSteps::From(VertexId cell) {
  const auto is_settled = [&] {
    const int steps = steps_[At(cell)];
    return steps == next_[At(cell)] && (open_.empty() || open_.front().first >= steps);
  };
  while (!open_.empty() && !is_settled()) {
    std::ranges::pop_heap(open_, std::greater());
    const Open open = open_.back();
    open_.pop_back();
    if (IsOpen(open)) WorkOut(open.second);
  }
  const int steps = steps_[At(cell)];
  return steps == kNoWay ? Farthest() + 1.0 : steps;
}

void GridSteps::WorkOut(int cell) {
  ++worked_out_;
  if (steps_[At(cell)] > next_[At(cell)]) {
    steps_[At(cell)] = next_[At(cell)];
  } else {
    steps_[At(cell)] = kNoWay;
    OpenIfDifferent(cell);
  }
  RenewAround(cell);
}

void GridSteps::RenewAround(int cell) {
  for (const Cell offset : kNeighbourOffsets) {
    const Cell next = known_.CellAt(At(cell)) + offset;
    if (known_.Contains(next)) Renew(static_cast<int>(known_.IndexOf(next)));
  }
}

void GridSteps::Renew(int cell) {
  const int next = StepsByNeighbours(cell);
  if (std::exchange(next_[At(cell)], next) != next) OpenIfDifferent(cell);
}

void GridSteps::OpenIfDifferent(int cell) {
  const int steps = steps_[At(cell)];
  const int next = next_[At(cell)];
  if (steps == next) return;
  open_.emplace_back(std::min(steps, next), cell);
  std::ranges::push_heap(open_, std::greater());
  if (open_.size() <= 4 * steps_.size()) return;
  // A cell that changes to and fro, farther away than what is asked for, is there again each time.
  std::erase_if(open_, [this](const Open& open) { return !IsOpen(open); });
  std::ranges::sort(open_);  // which is such a heap
  open_.erase(std::unique(open_.begin(), open_.end()), open_.end());
}

bool GridSteps::IsOpen(const Open& open) const {
  const int steps = steps_[At(open.second)];
  const int next = next_[At(open.second)];
  return steps != next && open.first == std::min(steps, next);
}

int GridSteps::StepsByNeighbours(int cell) const {
  const Cell from = known_.CellAt(At(cell));
  if (!MayBeFree(known_, from)) return kNoWay;
  if (std::ranges::binary_search(goals_, cell)) return 0;
  int fewest = kNoWay;
  for (const Cell offset : kNeighbourOffsets) {
    const Cell to = from + offset;
    if (!known_.Contains(to)) continue;
    const int steps = steps_[known_.IndexOf(to)];
    if (steps < fewest) fewest = std::min(fewest, EntrySteps(to) + steps);
  }
  return fewest;
}

int GridSteps::EntrySteps(Cell cell) const {
  if (!MayBeFree(known_, cell) || std::ranges::binary_search(occupied_, cell)) return kNoWay;
  const bool is_on_the_way =
      counts_.guidance.empty() || std::ranges::binary_search(counts_.guidance, cell);
  const int detour = is_on_the_way ? 1 : counts_.off_guidance;
  if (known_[cell] == Occupancy::kFree) return detour;
  const bool is_doubtful = counts_.belief && IsBelievedWall(*counts_.belief, known_.IndexOf(cell));
  return 2 * detour * (is_doubtful ? counts_.believed_wall : 1);
}

double GridSteps::Farthest() const {
  int farthest = -1;
  for (const int steps : steps_) farthest = std::max(farthest, steps < kNoWay ? steps : -1);
  return farthest;
}

}  // namespace conav::planner
