#include "planner/search/view_information.h"

#include <algorithm>

#include "common/runtime/demand.h"

namespace conav::planner {

std::size_t ViewInformation::PlaceHash::operator()(const Place& place) const {
  std::uint64_t hash = static_cast<std::uint64_t>(place.vertex) + 1;
  for (const std::uint64_t word : place.visited) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
  }
  return hash;
}

ViewInformation::ViewInformation(const SearchProblem& problem, OfferedActions& offered,
                                 PerceptionModel& model)
    : problem_(problem), offered_(offered), model_(model) {}

Result<double> ViewInformation::Of(const PathState& path, std::size_t index) {
  place_.vertex = path.vertex();
  place_.visited.assign(path.visited().begin(), path.visited().end());
  auto found = known_.find(place_);
  if (found == known_.end()) {
    auto edits = Ask(path);
    if (!edits) return tl::unexpected(edits.error());
    found = known_.emplace(place_, *std::move(edits)).first;
  } else {
    ++counts_.cached;
  }
  DEMAND(index < found->second.size(), index);
  return found->second[index];
}

Result<std::vector<double>> ViewInformation::Ask(const PathState& path) {
  const std::vector<Cell> cells = CellsOf(path);
  const auto headings = problem_.graph.HeadingsAt(path.vertex());
  std::vector<PerceptionQuery> queries;
  for (const int view : offered_.At(path.vertex()).views) {
    queries.push_back({.belief = problem_.belief,
                       .path = cells,
                       .cell = problem_.graph.CellOf(path.vertex()),
                       .heading_rad = headings[static_cast<std::size_t>(view)],
                       .visible = problem_.graph.ViewFrom(path.vertex(), view)});
  }
  const auto answers = model_.Predict(queries);
  if (!answers) return tl::unexpected(answers.error());
  DEMAND(answers->size() == queries.size(), answers->size(), queries.size());
  ++counts_.calls;
  counts_.queries += static_cast<std::uint32_t>(queries.size());
  std::vector<double> edits;
  for (const PerceptionAnswer& answer : *answers) edits.push_back(ExpectedEdits(answer));
  return edits;
}

std::vector<Cell> ViewInformation::CellsOf(const PathState& path) const {
  std::vector<Cell> cells(path.other_cells().begin(), path.other_cells().end());
  for (VertexId vertex = 0; vertex < problem_.graph.vertex_count(); ++vertex) {
    if (path.visits(vertex) > 0) cells.push_back(problem_.graph.CellOf(vertex));
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

}  // namespace conav::planner
