#include "planner/decision/leases.h"

#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "common/runtime/random.h"

namespace conav::planner {
namespace {

using namespace std::chrono_literals;

std::set<std::string> Robots(int count) {
  std::set<std::string> robots;
  for (int i = 1; i <= count; ++i) robots.insert(fmt::format("r{}", i));
  return robots;
}

/// By how many robots the assignment of the members differs at most.
std::ptrdiff_t Spread(const std::vector<Member>& members,
                      const std::map<std::string, std::string>& assignment) {
  std::vector<std::ptrdiff_t> loads;
  for (const Member& member : members) {
    loads.push_back(std::count_if(assignment.begin(), assignment.end(), [&](const auto& assigned) {
      return assigned.second == member.instance;
    }));
  }
  const auto [low, high] = std::ranges::minmax(loads);
  return high - low;
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
  std::vector<int> held;
  for (const Member& member : members) held.push_back(static_cast<int>(member.holds.size()));
  std::sort(held.begin(), held.end());  // those that hold most may keep one more
  int moves = 0;
  int i = 0;
  for (const int holds : held) moves += std::max(0, holds - (robots + i++) / count);
  return moves;
}

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
    REQUIRE(Spread(members, assignment) <= 1);
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

/// Robots as a sim keeps them, which refuses commands of older epochs, and planners that know each
/// other and command what they hold.
struct Fleet {
  struct Robot {
    std::uint64_t epoch = 0;
    std::uint64_t sequence_number = 0;
    std::string driver;
  };
  struct Planner {
    std::unique_ptr<LeaseTable> leases;
    std::vector<PlannerLease> inbox;
    std::set<std::string> own;
    bool hangs = false;

    std::uint64_t EpochOf(const std::string& robot) const {
      return own.contains(robot) ? leases->EpochOf(robot) : 0;
    }
  };

  explicit Fleet(int count) {
    for (const std::string& robot : Robots(count)) robots[robot] = {};
  }

  /// With `own` robots; none are all.
  void Start(const std::string& instance, int expected = 1, std::vector<std::string> own = {}) {
    if (own.empty()) {
      for (const auto& [name, robot] : robots) own.push_back(name);
    }
    LeaseTable::Options options{
        .node = "planner-" + instance, .instance = instance, .robots = own, .planners = expected};
    planners[instance].leases = std::make_unique<LeaseTable>(options, clock.Now());
    planners[instance].own = {own.begin(), own.end()};
  }
  /// a and b, which know of each other and hold their shares.
  void StartTwo() {
    for (const char* name : {"a", "b"}) Start(name, 2);
    Run(1s);
  }
  void Stop(const std::string& instance) {
    const PlannerLease farewell = planners.at(instance).leases->Farewell();
    planners.erase(instance);
    for (auto& [other, planner] : planners) planner.inbox.push_back(farewell);
  }
  void HangFor10s(const std::string& instance) {
    planners.at(instance).hangs = true;
    Run(10s);
    planners.at(instance).hangs = false;
  }

  /// One turn of everybody who does not hang, 50 ms apart.
  void Turn() {
    clock.Advance(50ms);
    for (auto& [instance, planner] : planners) {
      if (planner.hangs) continue;
      Listen(planner);
      Act(instance, planner);
    }
  }
  void Run(std::chrono::milliseconds time) {
    for (const auto end = clock.Now() + time; clock.Now() < end;) Turn();
  }

  void Listen(Planner& planner) {
    for (const auto& [name, robot] : robots) {
      planner.leases->Receive(name, robot.epoch, robot.sequence_number, clock.Now());
    }
    for (const PlannerLease& lease : planner.inbox) {
      REQUIRE(planner.leases->Receive(lease, clock.Now()));
    }
    planner.inbox.clear();
  }

  void Act(const std::string& instance, Planner& planner) {
    const auto changes = planner.leases->Turn(clock.Now());
    for (const std::string& robot : changes.to_release) planner.leases->Released(robot);
    for (auto& [name, robot] : robots) Command(instance, planner.EpochOf(name), robot);
    const auto lease = planner.leases->Announcement(clock.Now());
    if (!lease) return;
    for (auto& [other, listener] : planners) listener.inbox.push_back(*lease);
  }

  void Command(const std::string& instance, std::uint64_t epoch, Robot& robot) {
    if (epoch == 0) return;
    if (epoch < robot.epoch) {
      ++refused;
      return;
    }
    if (robot.driver != instance) ++changes_of_hands;
    robot = {epoch, robot.sequence_number + 1, instance};
  }

  std::ptrdiff_t HeldBy(const std::string& instance) const {
    return std::ranges::count_if(
        robots, [&](const auto& robot) { return planners.at(instance).EpochOf(robot.first) != 0; });
  }
  /// Whether each robot is held by one planner and no other.
  bool EachHeldOnce() const {
    return std::ranges::all_of(robots, [&](const auto& robot) {
      return 1 == std::ranges::count_if(planners, [&](const auto& planner) {
               return planner.second.EpochOf(robot.first) != 0;
             });
    });
  }

  FakeClock clock;
  std::map<std::string, Robot> robots;
  std::map<std::string, Planner> planners;
  int refused = 0;  // commands of a planner that another one had superseded
  int changes_of_hands = 0;
};

/// A table of process `instance` for r1 alone.
LeaseTable TableOf(const std::string& instance) {
  return LeaseTable({.node = "p", .instance = instance, .robots = {"r1"}}, {});
}

/// The same, which has taken r1.
LeaseTable HolderOf(const std::string& instance) {
  LeaseTable table = TableOf(instance);
  table.Receive("r1", 0, 0, {});
  REQUIRE(table.Turn({}).taken.size() == 1);
  return table;
}

TEST_CASE("a robot that nobody knows, or that somebody commands until it stops, is not taken",
          "[planner][lease]") {
  LeaseTable unknown = TableOf("a");
  for (const auto time : {0s, 1s, 10s}) {
    CHECK(unknown.Turn(Clock::TimePoint(time)).taken.empty());
  }
  Clock::TimePoint now{};
  LeaseTable leases = TableOf("a");
  std::uint64_t sequence_number = 1;
  for (int i = 0; i < 100; ++i) {
    now += 100ms;
    leases.Receive("r1", 7, ++sequence_number, now);
    REQUIRE(leases.Turn(now).taken.empty());
  }
  LeaseTable::Changes changes;
  int turns = 0;
  while (changes.taken.empty() && turns++ < 100) changes = leases.Turn(now += 100ms);
  REQUIRE(changes.taken.size() == 1);
  CHECK(changes.taken[0].lease_epoch == 8);
  CHECK(turns == 20);
}

TEST_CASE("planners share the robots, expected ones before the first command", "[planner][lease]") {
  Fleet expected(6);
  for (const char* name : {"a", "b", "c"}) expected.Start(name, 3);
  expected.Run(500ms);
  for (const char* name : {"a", "b", "c"}) CHECK(expected.HeldBy(name) == 2);
  CHECK(expected.changes_of_hands == 6);
  CHECK(expected.EachHeldOnce());
  Fleet unexpected(2);  // both start at once and know nothing of each other
  for (const char* name : {"a", "b"}) unexpected.Start(name);
  unexpected.Run(1s);
  for (const char* name : {"a", "b"}) CHECK(unexpected.HeldBy(name) == 1);
  CHECK(unexpected.EachHeldOnce());
}

TEST_CASE("an expected planner that does not come is not waited for longer than the timeout",
          "[planner][lease]") {
  Fleet fleet(2);
  fleet.Start("a", 2);
  fleet.Run(1900ms);
  CHECK(fleet.HeldBy("a") == 0);
  fleet.Run(200ms);
  CHECK(fleet.HeldBy("a") == 2);
}

TEST_CASE("of two that hold a robot the higher epoch keeps it, of equal ones the higher instance",
          "[planner][lease]") {
  LeaseTable low = HolderOf("a");
  LeaseTable high = HolderOf("b");
  const auto from_low = *low.Announcement({});
  REQUIRE(low.Receive(*high.Announcement({}), {}));
  REQUIRE(high.Receive(from_low, {}));
  CHECK(low.Turn({}).lost == std::vector<std::string>{"r1"});
  CHECK(high.Turn({}).lost.empty());
  CHECK(high.EpochOf("r1") == 1);
  REQUIRE(high.Receive({.node = "q", .instance = "a", .robots = {"r1"}, .holds = {{"r1", 2}}}, {}));
  CHECK(high.Turn({}).lost.size() == 1);
  CHECK(high.DriverOf("r1") == "q");
  LeaseTable shown = HolderOf("a");  // the robot itself shows the higher epoch
  shown.Receive("r1", 5, 1, {});
  CHECK(shown.Turn({}).lost.size() == 1);
  CHECK(shown.EpochOf("r1") == 0);
}

// The faults report's S3b: "A forged PlannerLease with a high epoch makes the planner drop the robot for
// as long as it is announced and 2 s longer".
TEST_CASE("a lease epoch that no robot would take is refused, the last that it would is not",
          "[planner][lease]") {
  LeaseTable table = HolderOf("a");
  table.Receive("r1", 5, 1, {});
  const std::uint64_t limit = 5 + kMaxCounterStep;
  const auto claims = [&](std::uint64_t epoch) {
    return table.Receive({.node = "q", .instance = "b", .robots = {"r1"}, .holds = {{"r1", epoch}}},
                         {});
  };
  const std::uint64_t far = GENERATE(1'000'006ULL, 18446744073709551615ULL);
  const auto refused = claims(far);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kRefused);
  CHECK_THAT(refused.error().text, Catch::Contains("r1"));
  CHECK(table.DriverOf("r1") != "q");
  CHECK(claims(limit));
  CHECK(table.DriverOf("r1") == "q");
}

TEST_CASE("the robots of a planner that leaves are taken over at once, of a killed one later",
          "[planner][lease]") {
  Fleet left(4);
  left.StartTwo();
  left.Stop("b");
  left.Turn();
  CHECK(left.HeldBy("a") == 4);
  Fleet fleet(4);
  fleet.StartTwo();
  REQUIRE(fleet.HeldBy("b") == 2);
  const auto epoch = fleet.robots.at("r2").epoch;
  fleet.planners.erase("b");
  fleet.Run(1500ms);
  CHECK(fleet.HeldBy("a") == 2);
  fleet.Run(700ms);
  CHECK(fleet.HeldBy("a") == 4);
  CHECK(fleet.robots.at("r2").epoch == epoch + 1);
  CHECK(fleet.refused == 0);
}

TEST_CASE("a planner that hung and comes back does not fight for its robots", "[planner][lease]") {
  Fleet fleet(4);
  fleet.StartTwo();
  fleet.HangFor10s("b");
  CHECK(fleet.HeldBy("a") == 4);
  const int before = fleet.changes_of_hands;
  fleet.Run(10s);
  CHECK(fleet.HeldBy("a") == 2);
  CHECK(fleet.HeldBy("b") == 2);
  CHECK(fleet.EachHeldOnce());
  CHECK(fleet.changes_of_hands == before + 2);  // its share comes back by handing over, once
}

TEST_CASE("a planner that hung takes nothing from the others, whose messages it missed meanwhile",
          "[planner][lease]") {
  Fleet fleet(1);
  fleet.Start("a");
  fleet.Run(1s);
  fleet.Start("b");
  fleet.Run(1s);
  REQUIRE(fleet.HeldBy("a") == 1);
  fleet.HangFor10s("b");
  fleet.Run(10s);
  CHECK(fleet.HeldBy("a") == 1);
  CHECK(fleet.changes_of_hands == 1);
}

TEST_CASE("a lone planner takes every robot that nobody commands at once, also after it hung",
          "[planner][lease]") {
  Fleet fleet(2);
  fleet.Start("a");
  fleet.Turn();
  CHECK(fleet.HeldBy("a") == 2);
  fleet.HangFor10s("a");
  fleet.Turn();
  CHECK(fleet.HeldBy("a") == 2);
  CHECK(fleet.robots.at("r1").epoch == 1);
}

TEST_CASE("planners with disjoint lists leave each other's robots alone", "[planner][lease]") {
  Fleet fleet(4);
  fleet.Start("a", 1, {"r1", "r2", "r3"});
  fleet.Start("b", 1, {"r4"});
  fleet.Run(4s);
  CHECK(fleet.HeldBy("a") == 3);
  CHECK(fleet.HeldBy("b") == 1);
  CHECK(fleet.changes_of_hands == 4);
  CHECK(fleet.planners.at("b").leases->DriverOf("r1") == "planner-a");
}

TEST_CASE("when planners come, die, hang and come back, each robot has one driver in the end",
          "[planner][lease]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Fleet fleet(static_cast<int>(random.Uniform(1, 9)));
    int started = 0;
    const auto start = [&] {
      fleet.Start(fmt::format("p{:02}", random.Uniform(0, 9) * 10 + started++));
    };
    start();
    for (int event = 0; event < 12; ++event) {
      fleet.Run(std::chrono::milliseconds(random.Uniform(0, 4000)));
      const auto last = static_cast<std::int64_t>(fleet.planners.size()) - 1;
      const auto planner = std::next(fleet.planners.begin(), random.Uniform(0, last));
      const auto what = random.Uniform(0, 3);
      if (what == 0 || last == 0) {
        start();
      } else if (what == 1) {
        fleet.planners.erase(planner);
      } else {
        planner->second.hangs = !planner->second.hangs;
      }
    }
    for (auto& [name, planner] : fleet.planners) planner.hangs = false;
    fleet.Run(8s);
    INFO("seed " << seed);
    REQUIRE(fleet.EachHeldOnce());
    const int before = fleet.changes_of_hands;
    fleet.Run(20s);
    REQUIRE(fleet.changes_of_hands == before);
  }
}

}  // namespace
}  // namespace conav::planner
