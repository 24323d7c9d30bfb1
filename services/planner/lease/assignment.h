#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace conav::planner {

/// One live planner process, as far as the sharing of robots goes.
struct Member {
  std::string instance;
  std::set<std::string> robots;  // that it is configured for
  std::set<std::string> holds;   // a part of these; no robot is held by two
};

/// Which member shall drive each robot: robot -> instance.
///
/// A robot stays with the member that holds it, as far as that is fair; the others go to the member
/// with the fewest. Then robots move as long as one move makes two members more equal, the last in
/// order of names first. So members with the same robots differ by one at most, and no more robots
/// move than that takes. The result does not depend on the order of `members`: processes that know
/// the same come to the same, and what they do about it one by one leads there, too.
std::map<std::string, std::string> AssignRobots(std::vector<Member> members);

}  // namespace conav::planner
