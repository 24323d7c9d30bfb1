#include "planner/decision/situation_problem.h"

#include "planner/decision/known_wall.h"
#include "planner/decision/traffic.h"

namespace conav::planner {
namespace {

std::vector<Cell> TakenCells(const Situation& situation) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < situation.map.cells.size(); ++i) {
    const Cell cell = situation.map.cells.CellAt(i);
    if (IsTaken(situation, cell)) cells.push_back(cell);
  }
  return cells;
}

std::vector<Cell> PathOf(const Situation& situation) {
  return situation.guidance ? situation.guidance->path : std::vector<Cell>{};
}

/// Whether the operator's path leads through a wall that the robot knows of.
bool IsBlocked(const Situation& situation) {
  return IsKnownBlocked(situation.map.cells, PathOf(situation));
}

}  // namespace

std::shared_ptr<const GridViews> ViewsFor(const Situation& situation, int headings,
                                          std::shared_ptr<const GridViews> kept) {
  const GridViews::Options options{
      .headings = headings, .lens = situation.lens, .cell_size_m = situation.map.cell_size_m};
  if (kept && kept->options() == options) return kept;
  return std::make_shared<const GridViews>(options);
}

SituationProblem::SituationProblem(const Situation& situation, BeliefGrid belief,
                                   std::vector<SentView> withheld,
                                   std::shared_ptr<const GridViews> views, const Reliance& reliance)
    : graph_(situation.map.cells, TakenCells(situation), std::move(views), {}),
      belief_(std::move(belief)) {
  const auto start = graph_.VertexAt(situation.state.cell);
  if (!start) return;
  const bool counts_as_none = !reliance.blocked_path_guides && IsBlocked(situation);
  problem_.emplace(
      SearchProblem{.graph = graph_,
                    .start = *start,
                    .heading_rad = situation.state.heading_rad,
                    .path = situation.state.path,
                    .goals_left = situation.state.goals_left,
                    .guidance = counts_as_none ? std::vector<Cell>{} : PathOf(situation),
                    .guided_before = situation.guided_before && !counts_as_none,
                    .belief = belief_,
                    .information_weight = reliance.information_weight,
                    .sent_views = std::move(withheld)});
}

}  // namespace conav::planner
