#include "planner/search/offered_actions.h"

#include <algorithm>
#include <cmath>

#include "common/grid/geometry.h"

namespace conav::planner {

OfferedActions::OfferedActions(const SearchProblem& problem)
    : problem_(problem), views_(static_cast<std::size_t>(problem.graph.vertex_count())) {}

Actions OfferedActions::At(VertexId vertex) {
  auto& views = views_[static_cast<std::size_t>(vertex)];
  if (!views) views = OfferedViews(vertex);
  return {problem_.graph.EdgesFrom(vertex), *views};
}

std::vector<int> OfferedActions::OfferedViews(VertexId vertex) const {
  constexpr double kSameHeadingRad = 1e-6;
  const Cell cell = problem_.graph.CellOf(vertex);
  const auto headings = problem_.graph.HeadingsAt(vertex);
  std::vector<int> offered;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const auto is_this = [&](const SentView& sent) {
      return sent.cell == cell &&
             std::abs(WrapAngle(sent.heading_rad - headings[i])) < kSameHeadingRad;
    };
    if (std::none_of(problem_.sent_views.begin(), problem_.sent_views.end(), is_this)) {
      offered.push_back(static_cast<int>(i));
    }
  }
  return offered;
}

}  // namespace conav::planner
