#include "planner/decision/situation_problem.h"

namespace conav::planner {
namespace {

std::vector<Cell> CellsOf(const std::vector<Neighbour>& neighbours) {
  std::vector<Cell> cells;
  for (const Neighbour& neighbour : neighbours) cells.push_back(neighbour.cell);
  return cells;
}

GridGraph::Options GraphOptions(const Situation& situation, int headings) {
  GridGraph::Options options;
  options.headings = headings;
  options.lens = situation.lens;
  options.cell_size_m = situation.map.cell_size_m;
  return options;
}

}  // namespace

SituationProblem::SituationProblem(const Situation& situation, BeliefGrid belief,
                                   std::vector<SentView> withheld, int headings)
    : graph_(situation.map.cells, CellsOf(situation.neighbours), GraphOptions(situation, headings)),
      belief_(std::move(belief)) {
  const auto start = graph_.VertexAt(situation.state.cell);
  if (!start) return;
  problem_.emplace(
      SearchProblem{.graph = graph_,
                    .start = *start,
                    .path = situation.state.path,
                    .goals_left = situation.state.goals_left,
                    .guidance = situation.guidance ? situation.guidance->path : std::vector<Cell>{},
                    .guided_before = situation.guided_before,
                    .belief = belief_,
                    .sent_views = std::move(withheld)});
}

}  // namespace conav::planner
