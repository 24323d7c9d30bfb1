#pragma once

#include <cstddef>
#include <vector>

#include "planner/record/decision_record.h"

namespace conav::planner {

/// A node of the drawn tree.
struct PlacedNode {
  std::size_t node = 0;  // index into SearchReport::tree
  int parent = -1;       // index into the placed nodes; -1 = the root
  int depth = 0;
  double row = 0.0;      // a leaf has a row of its own, a parent lies amid its children
  bool on_line = false;  // of the action taken, then the most visited
};

struct TreeLayout {
  std::vector<PlacedNode> nodes;  // parents before their children
  int rows = 0;
  int depth = 0;  // of the deepest
};

/// The `limit` most visited nodes that lie at most `depth` below the root, children of a node by
/// visits from the top.
TreeLayout LayOut(const DecisionRecord& decision, std::size_t limit, int depth);

}  // namespace conav::planner
