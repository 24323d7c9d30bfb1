#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/runtime/random.h"
#include "planner/decision/leases.h"

using namespace conav;
using namespace conav::planner;

namespace {

std::set<std::string> Robots(int count) {
  std::set<std::string> robots;
  for (int i = 1; i <= count; ++i) robots.insert(fmt::format("r{}", i));
  return robots;
}

std::map<std::string, int> Loads(const std::vector<Member>& members,
                                 const std::map<std::string, std::string>& assignment) {
  std::map<std::string, int> loads;
  for (const Member& member : members) loads[member.instance] = 0;
  for (const auto& [robot, instance] : assignment) ++loads.at(instance);
  return loads;
}

int Spread(const std::map<std::string, int>& loads) {
  const auto [low, high] = std::minmax_element(
      loads.begin(), loads.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return high->second - low->second;
}

/// Held robots that the assignment takes from their holder.
int Moves(const std::vector<Member>& members,
          const std::map<std::string, std::string>& assignment) {
  int moves = 0;
  for (const Member& member : members) {
    for (const std::string& robot : member.holds) {
      moves += assignment.at(robot) != member.instance ? 1 : 0;
    }
  }
  return moves;
}

/// Members that are all configured for all robots, of which most are held by somebody.
std::vector<Member> DrawMembers(Random& random) {
  const std::set<std::string> robots = Robots(static_cast<int>(random.Uniform(1, 20)));
  std::vector<Member> members(static_cast<std::size_t>(random.Uniform(1, 6)));
  for (std::size_t i = 0; i < members.size(); ++i) {
    members[i] = {fmt::format("p{}", i), robots, {}};
  }
  const auto count = static_cast<std::int64_t>(members.size());
  for (const std::string& robot : robots) {
    const std::int64_t holder = random.Uniform(0, count);
    if (holder < count) members[static_cast<std::size_t>(holder)].holds.insert(robot);
  }
  return members;
}

/// Fewest moves after which no member has more than the larger share.
int FewestMoves(const std::vector<Member>& members) {
  const int robots = static_cast<int>(members.front().robots.size());
  const int count = static_cast<int>(members.size());
  int larger_left = robots % count;  // members that may have one more
  int moves = 0;
  std::vector<int> held;
  for (const Member& member : members) held.push_back(static_cast<int>(member.holds.size()));
  std::sort(held.rbegin(), held.rend());
  for (const int holds : held) {
    int share = robots / count;
    if (holds > share && larger_left > 0) {
      ++share;
      --larger_left;
    }
    moves += std::max(0, holds - share);
  }
  return moves;
}

}  // namespace

TEST_CASE("a robot goes to a member that is configured for it, and stays where that is fair",
          "[planner][lease]") {
  const auto all = Robots(4);
  const std::vector<std::pair<std::vector<Member>, std::map<std::string, std::string>>> rows{
      {{}, {}},
      {{{"a", {"r1", "r2"}, {}}}, {{"r1", "a"}, {"r2", "a"}}},
      {{{"a", all, all}, {"b", all, {}}}, {{"r1", "a"}, {"r2", "a"}, {"r3", "b"}, {"r4", "b"}}},
      {{{"b", {"r1"}, {"r1"}}, {"a", {"r1"}, {}}}, {{"r1", "b"}}},
      {{{"a", {"r1", "r2"}, {"r1", "r2"}}, {"b", {"r4"}, {}}},
       {{"r1", "a"}, {"r2", "a"}, {"r4", "b"}}}};
  for (const auto& [members, assignment] : rows) CHECK(AssignRobots(members) == assignment);
}

TEST_CASE("members differ by one at most, by the fewest moves, in any order of announcements",
          "[planner][lease]") {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    auto members = DrawMembers(random);
    const auto assignment = AssignRobots(members);
    REQUIRE(assignment.size() == members.front().robots.size());
    REQUIRE(Spread(Loads(members, assignment)) <= 1);
    REQUIRE(Moves(members, assignment) == FewestMoves(members));
    random.Shuffle(members);
    REQUIRE(AssignRobots(members) == assignment);
    for (Member& member : members) {  // what was assigned stays once it is held
      member.holds.clear();
      for (const auto& [robot, instance] : assignment) {
        if (instance == member.instance) member.holds.insert(robot);
      }
    }
    REQUIRE(AssignRobots(members) == assignment);
  }
}
