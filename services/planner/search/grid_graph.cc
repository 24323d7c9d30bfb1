#include "common/grid/geometry.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

GridViews::GridViews(const Options& options) : options_(options) {
  DEMAND(options.headings >= 0, options.headings);
  for (int i = 0; i < options.headings; ++i) {
    headings_.push_back(HeadingFromIndex(i, options.headings));
    CameraView camera = ViewThrough(options.lens, {}, headings_.back(), options.cell_size_m);
    camera.rays = options.rays;
    camera.range_cells = options.range_cells;
    casters_.emplace_back(camera);
  }
}

GridGraph::GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now,
                     std::shared_ptr<const GridViews> views)
    : known_(std::move(known)), camera_(std::move(views)) {
  Grid<std::uint8_t> occupied(known_.rows(), known_.columns(), 0);
  for (const Cell cell : occupied_now) {
    if (occupied.Contains(cell)) occupied[cell] = 1;
  }
  for (VertexId vertex = 0; vertex < vertex_count(); ++vertex) {
    cells_.push_back(CellOf(vertex));
    first_edge_.push_back(edges_.size());
    AddEdges(cells_.back(), occupied);
  }
  first_edge_.push_back(edges_.size());
  views_.resize(known_.size() * camera_->headings().size());
}

GridGraph::GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now)
    : GridGraph(std::move(known), occupied_now,
                std::make_shared<const GridViews>(GridViews::Options())) {}

void GridGraph::AddEdges(Cell from, const Grid<std::uint8_t>& occupied) {
  if (!MayBeFree(from)) return;
  for (const Cell offset : kNeighbourOffsets) {
    const Cell to = from + offset;
    if (!known_.Contains(to) || !MayBeFree(to) || occupied[to] != 0) continue;
    const double feasibility = known_[to] == Occupancy::kFree ? 1.0 : kUnknownFeasibility;
    const auto target = static_cast<VertexId>(known_.IndexOf(to));
    edges_.push_back({.target = target, .feasibility = feasibility, .uncertainty = target});
  }
}

bool GridGraph::MayBeFree(Cell cell) const {
  return known_[cell] == Occupancy::kFree ||
         (known_[cell] == Occupancy::kUnknown && !known_.OnBorder(cell));
}

Cell GridGraph::CellOf(VertexId vertex) const {
  return known_.CellAt(static_cast<std::size_t>(vertex));
}

std::span<const Cell> GridGraph::CellsOf(VertexId vertex) const {
  return std::span(cells_).subspan(static_cast<std::size_t>(vertex), 1);
}

std::optional<VertexId> GridGraph::VertexAt(Cell cell) const {
  if (!known_.Contains(cell) || !MayBeFree(cell)) return std::nullopt;
  return static_cast<VertexId>(known_.IndexOf(cell));
}

std::span<const Edge> GridGraph::EdgesFrom(VertexId vertex) const {
  const auto v = static_cast<std::size_t>(vertex);
  return std::span(edges_).subspan(first_edge_[v], first_edge_[v + 1] - first_edge_[v]);
}

std::span<const double> GridGraph::HeadingsAt(VertexId /*vertex*/) const {
  return camera_->headings();
}

const VisibleCells& GridGraph::ViewFrom(VertexId vertex, int index) const {
  const std::size_t headings = camera_->headings().size();
  auto& view =
      views_[static_cast<std::size_t>(vertex) * headings + static_cast<std::size_t>(index)];
  const std::lock_guard lock(mutex_);
  if (!view) view = camera_->Cast(known_, CellOf(vertex), index);
  return *view;
}

}  // namespace conav::planner
