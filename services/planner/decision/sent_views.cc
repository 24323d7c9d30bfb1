#include "planner/decision/sent_views.h"

#include <algorithm>

namespace conav::planner {
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
