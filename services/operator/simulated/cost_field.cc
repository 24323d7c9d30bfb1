#include "operator/simulated/cost_field.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

namespace conav::operators {

CostField::CostField(const Grid<double>& entry_costs, Cell source)
    : source_(source),
      cost_(entry_costs.rows(), entry_costs.columns(), kUnreachable),
      previous_(entry_costs.rows(), entry_costs.columns(), source) {
  using Entry = std::pair<double, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost_[source] = 0.0;
  open.push({0.0, source});
  while (!open.empty()) {
    const auto [cost, cell] = open.top();
    open.pop();
    if (cost > cost_[cell]) continue;
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!entry_costs.Contains(next)) continue;
      const double next_cost = cost + entry_costs[next];
      if (!(next_cost < cost_[next])) continue;
      cost_[next] = next_cost;
      previous_[next] = cell;
      open.push({next_cost, next});
    }
  }
}

std::vector<Cell> CostField::PathTo(Cell cell) const {
  DEMAND(cost_[cell] < kUnreachable, cell, source_);
  std::vector<Cell> path{cell};
  while (path.back() != source_) path.push_back(previous_[path.back()]);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace conav::operators
