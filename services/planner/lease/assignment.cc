#include "planner/lease/assignment.h"

#include <algorithm>
#include <optional>

namespace conav::planner {
namespace {

/// A member and what it would drive.
struct Share {
  const Member* member;
  std::set<std::string> robots;
};

bool HasFewer(const Share& a, const Share& b) { return a.robots.size() < b.robots.size(); }

void GiveToFewest(std::vector<Share>& shares, const std::string& robot) {
  Share* fewest = nullptr;
  for (Share& share : shares) {
    if (!share.member->robots.contains(robot)) continue;
    if (fewest == nullptr || HasFewer(share, *fewest)) fewest = &share;
  }
  if (fewest != nullptr) fewest->robots.insert(robot);
}

/// The last robot that `from` has and `to` may have.
std::optional<std::string> Movable(const Share& from, const Share& to) {
  for (auto robot = from.robots.rbegin(); robot != from.robots.rend(); ++robot) {
    if (to.member->robots.contains(*robot)) return *robot;
  }
  return std::nullopt;
}

/// Moves one robot between the two most unequal members for which that helps.
bool MoveOne(std::vector<Share>& shares) {
  Share* giver = nullptr;
  Share* taker = nullptr;
  std::size_t widest = 1;
  for (Share& from : shares) {
    for (Share& to : shares) {
      if (from.robots.size() <= to.robots.size() + widest || !Movable(from, to)) continue;
      widest = from.robots.size() - to.robots.size();
      giver = &from;
      taker = &to;
    }
  }
  if (giver == nullptr) return false;
  const std::string robot = *Movable(*giver, *taker);
  giver->robots.erase(robot);
  taker->robots.insert(robot);
  return true;
}

}  // namespace

std::map<std::string, std::string> AssignRobots(std::vector<Member> members) {
  std::sort(members.begin(), members.end(),
            [](const Member& a, const Member& b) { return a.instance < b.instance; });
  std::vector<Share> shares;
  std::set<std::string> unheld;
  for (const Member& member : members) {
    shares.push_back({&member, member.holds});
    unheld.insert(member.robots.begin(), member.robots.end());
  }
  for (const Member& member : members) {
    for (const std::string& robot : member.holds) unheld.erase(robot);
  }
  for (const std::string& robot : unheld) GiveToFewest(shares, robot);
  while (MoveOne(shares)) {
  }
  std::map<std::string, std::string> assignment;
  for (const Share& share : shares) {
    for (const std::string& robot : share.robots) assignment[robot] = share.member->instance;
  }
  return assignment;
}

}  // namespace conav::planner
