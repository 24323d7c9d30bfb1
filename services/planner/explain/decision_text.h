#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "planner/explain/decision_file.h"

namespace conav::planner {

/// Situation, root actions by visits with value and terms, and why; the action taken is marked *.
std::string DecisionText(const DecisionRecord& decision);

/// What a list says of a decision.
struct DecisionSummary {
  std::string robot;
  std::uint64_t number = 0;
  double time_s = 0.0;
  Cell cell;
  std::string action;
  bool snapshot = false;
  bool searched = false;
  double visit_share = 0.0;  // of the action taken
  double value = 0.0;
  double margin = 0.0;            // see Margin()
  double information_gain = 0.0;  // of a picture
};

DecisionSummary Summarise(const DecisionRecord& decision);

/// A line for each.
std::string ListText(std::span<const DecisionSummary> decisions);

/// Everything that was recorded of a decision, and why; cells as [row, column], headings in rad.
nlohmann::ordered_json DecisionJson(const DecisionRecord& decision);

nlohmann::ordered_json ListJson(std::span<const DecisionSummary> decisions);

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

/// An SVG document. Left the robot's map: its place, path since the last picture, goals, the
/// operator's path and mistakes, its plan, and for each cell and heading that the search asked
/// about an arrow as long as the picture's information gain. Right the search tree: the most
/// visited nodes, lines as wide as their share of visits, the line that was chosen in colour. Each
/// thing says its figures where the mouse rests.
std::string DecisionSvg(const DecisionRecord& decision);

}  // namespace conav::planner
