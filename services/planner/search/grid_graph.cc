#include <algorithm>

#include "common/grid/geometry.h"
#include "planner/search/grid_steps.h"
#include "planner/search/search_problem.h"

namespace conav::planner {
namespace {

StepCounts CountsOf(const SearchProblem& problem) {
  return {.believed_wall = problem.believed_wall_steps,
          .off_guidance = problem.off_guidance_steps,
          .belief = problem.belief,
          .guidance = problem.guidance};
}

}  // namespace

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
                     std::shared_ptr<const GridViews> views, std::shared_ptr<GridSteps> steps)
    : known_(std::move(known)),
      occupied_now_(occupied_now.begin(), occupied_now.end()),
      camera_(std::move(views)),
      steps_(steps ? std::move(steps) : std::make_shared<GridSteps>()),
      vertices_(known_.size()) {
  std::sort(occupied_now_.begin(), occupied_now_.end());
}

GridGraph::GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now)
    : GridGraph(std::move(known), occupied_now,
                std::make_shared<const GridViews>(GridViews::Options())) {}

GridGraph::Vertex& GridGraph::VertexLocked(VertexId vertex) const {
  Vertex& made = vertices_[static_cast<std::size_t>(vertex)];
  if (made.is_made) return made;
  made.is_made = true;
  made.cell = CellOf(vertex);
  made.edges = MakeEdges(made.cell);
  made.views.resize(camera_->headings().size());
  return made;
}

std::vector<Edge> GridGraph::MakeEdges(Cell from) const {
  std::vector<Edge> edges;
  if (!MayBeFree(from)) return edges;
  for (const Cell offset : kNeighbourOffsets) {
    const Cell to = from + offset;
    if (!known_.Contains(to) || !MayBeFree(to) || IsOccupied(to)) continue;
    const double feasibility = known_[to] == Occupancy::kFree ? 1.0 : kUnknownFeasibility;
    const auto target = static_cast<VertexId>(known_.IndexOf(to));
    edges.push_back({.target = target, .feasibility = feasibility, .uncertainty = target});
  }
  return edges;
}

bool GridGraph::IsOccupied(Cell cell) const {
  return std::binary_search(occupied_now_.begin(), occupied_now_.end(), cell);
}

bool GridGraph::MayBeFree(Cell cell) const {
  return known_[cell] == Occupancy::kFree ||
         (known_[cell] == Occupancy::kUnknown && !known_.OnBorder(cell));
}

Cell GridGraph::CellOf(VertexId vertex) const {
  return known_.CellAt(static_cast<std::size_t>(vertex));
}

std::span<const Cell> GridGraph::CellsOf(VertexId vertex) const {
  const std::lock_guard lock(mutex_);
  return {&VertexLocked(vertex).cell, 1};
}

std::optional<VertexId> GridGraph::VertexAt(Cell cell) const {
  if (!known_.Contains(cell) || !MayBeFree(cell)) return std::nullopt;
  return static_cast<VertexId>(known_.IndexOf(cell));
}

std::span<const Edge> GridGraph::EdgesFrom(VertexId vertex) const {
  const std::lock_guard lock(mutex_);
  return VertexLocked(vertex).edges;
}

std::span<const double> GridGraph::HeadingsAt(VertexId /*vertex*/) const {
  return camera_->headings();
}

const VisibleCells& GridGraph::ViewFrom(VertexId vertex, int index) const {
  const std::lock_guard lock(mutex_);
  auto& view = VertexLocked(vertex).views[static_cast<std::size_t>(index)];
  if (!view) view = camera_->Cast(known_, CellOf(vertex), index);
  return *view;
}

std::unique_ptr<StepsToGoals> GridGraph::StepsTo(const SearchProblem& problem,
                                                 std::vector<VertexId> goals) const {
  class Steps final : public StepsToGoals {
   public:
    Steps(std::mutex& mutex, GridSteps& steps) : mutex_(mutex), steps_(steps) {}
    double From(VertexId vertex) override {
      const std::lock_guard lock(mutex_);
      return steps_.From(vertex);
    }

   private:
    std::mutex& mutex_;
    GridSteps& steps_;
  };
  const std::lock_guard lock(mutex_);
  steps_->Update(known_, occupied_now_, std::move(goals), CountsOf(problem));
  return std::make_unique<Steps>(mutex_, *steps_);
}

}  // namespace conav::planner
