#include "planner/decision/situation_problem.h"

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
                                   std::shared_ptr<const GridViews> views,
                                   double information_weight)
    : graph_(situation.map.cells, TakenCells(situation), std::move(views), {}),
      belief_(std::move(belief)) {
  const auto start = graph_.VertexAt(situation.state.cell);
  if (!start) return;
  problem_.emplace(
      SearchProblem{.graph = graph_,
                    .start = *start,
                    .heading_rad = situation.state.heading_rad,
                    .path = situation.state.path,
                    .goals_left = situation.state.goals_left,
                    .guidance = situation.guidance ? situation.guidance->path : std::vector<Cell>{},
                    .guided_before = situation.guided_before,
                    .belief = belief_,
                    .information_weight = information_weight,
                    .sent_views = std::move(withheld)});
}

}  // namespace conav::planner
