#pragma once

#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"

namespace conav::planner {

/// Remembers which views a robot has sent, and on what belief: none is offered again while the
/// operator's map is unchanged in the cells that it shows, because the same picture would change
/// nothing the second time. Without this rule the reward lets the planner send one view for ever
/// (facts measured in the search experiment).
class SentViews {
 public:
  struct View {
    Cell cell;
    double heading_rad = 0.0;
    bool operator==(const View&) const = default;
  };

  /// The robot sends this view now. Its belief is taken at the next Update(), after the operator's
  /// answer.
  void Sent(const View& view, VisibleCells visible);

  /// The belief as it is at the next decision: views whose cells changed since are offered again.
  void Update(const BeliefGrid& belief);

  /// Views that must not be offered now.
  std::vector<View> Withheld() const;

 private:
  struct Entry {
    View view;
    std::vector<Cell> cells;
    std::vector<float> belief;  // of `cells` after the answer; empty until then
  };

  std::vector<Entry> entries_;
};

}  // namespace conav::planner
