#include "planner/search/search_problem.h"

#include <algorithm>
#include <cmath>

#include "common/grid/geometry.h"

namespace conav::planner {

double HiddenWorth(const SearchProblem& problem, const VisibleCells& visible) {
  if (problem.hidden.size() == 0) return 0.0;
  double likelihood = 0.0;
  for (const Cell cell : visible.free) likelihood += problem.hidden[cell];
  return problem.hidden_value * likelihood;
}

OfferedActions::OfferedActions(const SearchProblem& problem)
    : problem_(problem), offered_(static_cast<std::size_t>(problem.graph.vertex_count())) {
  for (const SentView& sent : problem.sent_views) {
    if (const auto vertex = problem.graph.VertexAt(sent.cell)) {
      sent_.emplace_back(*vertex, sent.heading_rad);
    }
  }
  std::sort(sent_.begin(), sent_.end());
}

void OfferedActions::LookUp(VertexId vertex, Offered& offered) {
  constexpr double kSameHeadingRad = 1e-6;
  const auto [first, last] =
      std::equal_range(sent_.begin(), sent_.end(), std::pair(vertex, 0.0),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto headings = problem_.graph.HeadingsAt(vertex);
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const bool was_sent = std::any_of(first, last, [&](const auto& sent) {
      return std::abs(WrapAngle(sent.second - headings[i])) < kSameHeadingRad;
    });
    if (!was_sent) offered.views.push_back(static_cast<int>(i));
  }
  offered.actions = {problem_.graph.EdgesFrom(vertex), offered.views};
  offered.is_known = true;
}

}  // namespace conav::planner
