#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "planner/search/search_problem.h"

// Users: grid_graph, and the method, which keeps it and its limits.

namespace conav::planner {

/// How often a step into a cell counts because of what the operator says: SearchProblem's
/// `believed_wall_steps` and `off_guidance_steps`, 1 to kMostStepCount.
struct StepCounts {
  int believed_wall = 1;
  int off_guidance = 1;
  SharedBelief belief;         // not looked at if believed_wall = 1
  std::vector<Cell> guidance;  // not looked at if off_guidance = 1
};
/// The longest way through a map of 1024 x 1024 cells still fits.
inline constexpr int kMostStepCount = 20;

/// The steps from the cells of a maze to the nearest goal (StepsToGoals), kept from one decision to
/// the next. A cell that became known, a goal that was reached or a robot that stands elsewhere
/// changes the steps of the cells behind it, and so does an edit or another path of the operator where
/// they count; only those are worked out again, and of them only those
/// no farther from the goals than what is asked for. The first question is a search over that part
/// of the map. The numbers are the same as if all were worked out again: steps are whole.
///
/// Source: LPA* without a heuristic; Koenig, Likhachev and Furcy, "Lifelong Planning A*", Artificial
/// Intelligence 155, 2004. Threads: one at a time.
class GridSteps {
 public:
  /// What holds from now on. `occupied` is sorted; goals are cells by index that may be free. A map
  /// of another size starts over, and so does the first path of the operator, or the end of the last.
  void Update(const OccupancyGrid& known, const std::vector<Cell>& occupied,
              std::vector<VertexId> goals, StepCounts counts = {});

  /// By Update(), at least one.
  double From(VertexId cell);

  /// Cells worked out so far, each as often as it was.
  std::uint64_t worked_out() const { return worked_out_; }
  /// Cells that wait to be worked out, some of them more than once; about 4 times the map's at most.
  std::size_t waiting() const { return open_.size(); }

 private:
  using Open = std::pair<int, int>;  // a cell's smaller number of steps; the cell

  void Begin();
  std::vector<int> ChangedCells(const OccupancyGrid& known, const std::vector<Cell>& occupied);
  void TakeCounts(StepCounts counts, std::vector<int>& changed);
  void Renew(int cell);
  void RenewAround(int cell);
  void OpenIfDifferent(int cell);
  void WorkOut(int cell);
  int StepsByNeighbours(int cell) const;
  int EntrySteps(Cell cell) const;
  bool IsOpen(const Open& open) const;
  double Farthest() const;

  OccupancyGrid known_;
  std::vector<Cell> occupied_;
  std::vector<VertexId> goals_;  // sorted
  StepCounts counts_;            // guidance: sorted
  std::vector<int> steps_;       // by cell: as worked out
  std::vector<int> next_;        // and by its neighbours now
  std::vector<Open> open_;       // heap of the cells where they differ; others are in it, too
  std::uint64_t worked_out_ = 0;
};

}  // namespace conav::planner
