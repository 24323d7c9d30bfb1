#include "planner/search/search_problem.h"

#include <algorithm>
#include <cmath>

#include "common/grid/geometry.h"

namespace conav::planner {

OfferedActions::OfferedActions(const SearchProblem& problem) {
  for (VertexId vertex = 0; vertex < problem.graph.vertex_count(); ++vertex) {
    first_.push_back({edges_.size(), views_.size()});
    const auto edges = problem.graph.EdgesFrom(vertex);
    edges_.insert(edges_.end(), edges.begin(), edges.end());
    AddViews(problem, vertex);
  }
  first_.push_back({edges_.size(), views_.size()});
}

void OfferedActions::AddViews(const SearchProblem& problem, VertexId vertex) {
  constexpr double kSameHeadingRad = 1e-6;
  const Cell cell = problem.graph.CellOf(vertex);
  const auto is_here = [&](Cell sent_from) {
    return sent_from == cell || problem.graph.VertexAt(sent_from) == vertex;
  };
  const auto headings = problem.graph.HeadingsAt(vertex);
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const auto is_this = [&](const SentView& sent) {
      return std::abs(WrapAngle(sent.heading_rad - headings[i])) < kSameHeadingRad &&
             is_here(sent.cell);
    };
    if (std::none_of(problem.sent_views.begin(), problem.sent_views.end(), is_this)) {
      views_.push_back(static_cast<int>(i));
    }
  }
}

}  // namespace conav::planner
