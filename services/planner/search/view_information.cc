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
                                 PerceptionModel& model, bool look_ahead)
    : problem_(problem), offered_(offered), model_(model), look_ahead_(look_ahead) {}

Result<double> ViewInformation::Of(const PathState& path, std::size_t index) {
  place_.vertex = path.vertex();
  place_.visited.assign(path.visited().begin(), path.visited().end());
  auto found = known_.find(place_);
  if (found == known_.end()) {
    if (const auto asked = AskAround(path); !asked) return tl::unexpected(asked.error());
    found = known_.find(place_);
  } else {
    ++counts_.cached;
  }
  DEMAND(found != known_.end() && index < found->second.size(), index);
  return found->second[index];
}

Result<void> ViewInformation::AskAround(const PathState& path) {
  asked_.clear();
  queries_.clear();
  AddQueries(place_, path);
  if (look_ahead_) {
    for (const Edge& edge : problem_.graph.EdgesFrom(place_.vertex)) {
      Place next{edge.target, place_.visited};
      next.visited[static_cast<std::size_t>(edge.target) / 64] |= std::uint64_t{1}
                                                                  << (edge.target % 64);
      if (!known_.contains(next)) AddQueries(next, path);
    }
  }
  const auto answers = model_.Predict(queries_);
  if (!answers) return tl::unexpected(answers.error());
  DEMAND(answers->size() == queries_.size(), answers->size(), queries_.size());
  ++counts_.calls;
  counts_.queries += static_cast<std::uint32_t>(queries_.size());
  auto answer = answers->begin();
  for (const Place& place : asked_) {
    std::vector<double>& edits = known_[place];
    for (std::size_t i = 0; i < offered_.At(place.vertex).views.size(); ++i) {
      edits.push_back(ExpectedEdits(*answer++));
    }
  }
  return {};
}

void ViewInformation::AddQueries(const Place& place, const PathState& path) {
  asked_.push_back(place);
  const std::vector<Cell> cells = CellsOf(place, path);
  const auto headings = problem_.graph.HeadingsAt(place.vertex);
  for (const int view : offered_.At(place.vertex).views) {
    queries_.push_back({.belief = problem_.belief,
                        .path = cells,
                        .cell = problem_.graph.CellOf(place.vertex),
                        .heading_rad = headings[static_cast<std::size_t>(view)],
                        .visible = problem_.graph.ViewFrom(place.vertex, view)});
  }
}

std::vector<Cell> ViewInformation::CellsOf(const Place& place, const PathState& path) const {
  std::vector<Cell> cells(path.other_cells().begin(), path.other_cells().end());
  for (VertexId vertex = 0; vertex < problem_.graph.vertex_count(); ++vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    if ((place.visited[v / 64] >> (v % 64) & 1U) != 0)
      cells.push_back(problem_.graph.CellOf(vertex));
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

}  // namespace conav::planner
