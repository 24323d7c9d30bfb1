#pragma once

#include <string>

#include "planner/record/decision_record.h"

namespace conav::planner {

/// An SVG document. Left the robot's map: its place, path since the last picture, goals, the
/// operator's path and mistakes, its plan, and for each cell and heading that the search asked
/// about an arrow as long as the picture's information gain. Right the search tree: the most
/// visited nodes, lines as wide as their share of visits, the line that was chosen in colour. Each
/// thing says its figures where the mouse rests.
std::string DecisionSvg(const DecisionRecord& decision);

}  // namespace conav::planner
