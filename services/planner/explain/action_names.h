#pragma once

#include <string>

#include "common/protocol/search_report.h"

namespace conav::planner {

/// "east", "north-east"; "30 degrees" where it is none of eight. 0 is east, counter-clockwise.
std::string HeadingName(double heading_rad);

/// "move east to (7,8)" from `robot`, "picture to the north-east", "low-level action".
std::string ActionName(const SearchAction& action, Cell robot);

/// Whether both command the same.
bool IsSameCommand(const SearchAction& a, const SearchAction& b);

}  // namespace conav::planner
