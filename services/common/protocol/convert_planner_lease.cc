#include <limits>
#include <set>

#include "common/protocol/convert.h"
#include "common/protocol/convert_checks.h"

namespace conav {

using convert::Checks;

namespace {

void EachOnce(Checks& checks, const char* field, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) checks.Refuse(fmt::format("{}: {} is there twice", field, name));
  }
}

std::vector<PlannerLease::Held> ToHolds(Checks& checks,
                                        const std::vector<conav_msgs::msg::HeldRobot>& messages) {
  std::vector<PlannerLease::Held> holds;
  std::vector<std::string> names;
  checks.Size("holds", messages.size(), convert::kMaxRobots);
  for (std::size_t i = 0; i < messages.size() && !checks.failed(); ++i) {
    const std::string at = fmt::format("holds[{}].", i);
    names.push_back(checks.Name(at + "robot", messages[i].robot()));
    if (messages[i].lease_epoch() == 0) checks.Refuse(at + "lease_epoch = 0 is below 1");
    holds.push_back({names.back(), messages[i].lease_epoch()});
  }
  EachOnce(checks, "holds", names);
  return holds;
}

}  // namespace

Result<PlannerLease> ToDomain(const conav_msgs::msg::PlannerLease& message) {
  Checks checks;
  PlannerLease lease;
  lease.node = checks.Client("node", message.node());
  lease.instance = checks.Client("instance", message.instance());
  checks.Size("robots", message.robots().size(), convert::kMaxRobots);
  for (std::size_t i = 0; i < message.robots().size() && !checks.failed(); ++i) {
    lease.robots.push_back(checks.Name(fmt::format("robots[{}]", i), message.robots()[i]));
  }
  EachOnce(checks, "robots", lease.robots);
  lease.holds = ToHolds(checks, message.holds());
  lease.load = checks.Range("load", message.load(), 0.0,
                            static_cast<double>(std::numeric_limits<int>::max()));
  lease.leaving = message.leaving();
  if (lease.leaving && !lease.holds.empty()) checks.Refuse("leaving, and holds robots");
  if (checks.failed()) return checks.failure();
  return lease;
}

conav_msgs::msg::PlannerLease ToMessage(const PlannerLease& lease) {
  conav_msgs::msg::PlannerLease message;
  message.node(lease.node);
  message.instance(lease.instance);
  message.robots(lease.robots);
  for (const PlannerLease::Held& held : lease.holds) {
    conav_msgs::msg::HeldRobot robot;
    robot.robot(held.robot);
    robot.lease_epoch(held.lease_epoch);
    message.holds().push_back(robot);
  }
  message.load(lease.load);
  message.leaving(lease.leaving);
  return message;
}

Result<RobotWay> ToDomain(const conav_msgs::msg::RobotWay& message) {
  Checks checks;
  RobotWay way;
  way.robot = checks.Name("robot", message.robot());
  way.way = checks.Cells("way", message.way());
  way.room.way = checks.Cells("room", message.room());
  way.room.right.tier = checks.Enumerator("room_tier", message.room_tier(), RightOfWay::kShutIn,
                                          RightOfWay::kHasNone);
  way.room.right.robot = checks.OptionalName("room_for", message.room_for());
  way.room.right.passed_on = message.room_passed_on();
  if (checks.failed()) return checks.failure();
  return way;
}

conav_msgs::msg::RobotWay ToMessage(const RobotWay& way) {
  conav_msgs::msg::RobotWay message;
  message.robot(way.robot);
  message.way(convert::ToCellMessages(way.way));
  message.room(convert::ToCellMessages(way.room.way));
  message.room_tier(way.room.right.tier);
  message.room_for(way.room.right.robot);
  message.room_passed_on(way.room.right.passed_on);
  return message;
}

}  // namespace conav
