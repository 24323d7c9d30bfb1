#include "operator/supervision/control.h"

#include <fmt/format.h>

#include <algorithm>

namespace conav::operators {
namespace {

bool IsHeldByOther(const ControlRegistry::Robot& robot, const std::string& client,
                   Clock::TimePoint now) {
  return !robot.holder.empty() && robot.holder != client && now < robot.held_until;
}

}  // namespace

ControlRegistry::ControlRegistry(const std::map<std::string, std::string>& world_of_robot,
                                 ControlOptions options)
    : options_(options) {
  for (const auto& [name, world] : world_of_robot) {
    Robot& robot = robots_[name];
    robot.world = world;
    robot.stop.world = world;
    robot.stop.robot = name;
    if (!options.start_stopped) continue;
    robot.stop.revision = 1;
    robot.stop.stopped = true;
    robot.stop.reason = "stopped until somebody resumes it";
  }
}

std::string ControlRegistry::CheckCommand(const std::string& client, const std::string& name,
                                          Clock::TimePoint now) const {
  const auto found = robots_.find(name);
  if (found == robots_.end() || !IsHeldByOther(found->second, client, now)) return "";
  return fmt::format("{} has control of {}: take over first", found->second.holder, name);
}

std::string ControlRegistry::CheckEdit(const std::string& client, const std::string& world,
                                       Clock::TimePoint now) const {
  const Robot* held = nullptr;
  for (const auto& [name, robot] : robots_) {
    if (robot.world != world) continue;
    if (!IsHeldByOther(robot, client, now)) return "";
    held = &robot;
  }
  if (held == nullptr) return "";
  return fmt::format("{} has control of all robots of {}: take over first", held->holder, world);
}

void ControlRegistry::Renew(const std::string& client, Clock::TimePoint now) {
  for (auto& [name, robot] : robots_) {
    if (robot.holder != client) continue;
    robot.held_until = now + Seconds(options_.control_s);
    ++version_;
  }
}

Result<std::vector<std::string>> ControlRegistry::Resolve(
    const std::vector<std::string>& names) const {
  std::vector<std::string> all;
  for (const auto& [name, robot] : robots_) all.push_back(name);
  if (names.empty()) return all;
  for (const std::string& name : names) {
    if (!robots_.contains(name)) {
      return Fail(ErrorCode::kNotFound, fmt::format("robot '{}' is unknown", name));
    }
  }
  return names;
}

Result<void> ControlRegistry::Take(const std::string& client, const TakeControlRequest& request,
                                   Clock::TimePoint now) {
  const auto names = Resolve(request.robots);
  if (!names) return tl::unexpected(names.error());
  for (const std::string& name : *names) {
    const Robot& robot = robots_.at(name);
    if (!IsHeldByOther(robot, client, now) || !request.reason.empty()) continue;
    return Fail(ErrorCode::kRefused,
                fmt::format("{} has control of {}: say why you take over", robot.holder, name));
  }
  for (const std::string& name : *names) {
    Robot& robot = robots_.at(name);
    robot.holder = client;
    robot.reason = request.reason;
    robot.held_until = now + Seconds(options_.control_s);
  }
  ++version_;
  return {};
}

Result<void> ControlRegistry::Release(const std::string& client,
                                      const ReleaseControlRequest& request) {
  const auto names = Resolve(request.robots);
  if (!names) return tl::unexpected(names.error());
  for (const std::string& name : *names) {
    Robot& robot = robots_.at(name);
    if (robot.holder == client) Free(robot);
  }
  return {};
}

void ControlRegistry::ReleaseAll(const std::string& client) {
  for (auto& [name, robot] : robots_) {
    if (robot.holder == client) Free(robot);
  }
}

void ControlRegistry::Expire(Clock::TimePoint now) {
  for (auto& [name, robot] : robots_) {
    if (!robot.holder.empty() && now >= robot.held_until) Free(robot);
  }
}

void ControlRegistry::Free(Robot& robot) {
  robot.holder.clear();
  robot.reason.clear();
  ++version_;
}

Result<std::vector<StopOrder>> ControlRegistry::SetStopped(const std::vector<std::string>& names,
                                                           bool stopped, const std::string& client,
                                                           const std::string& reason,
                                                           SimTime now) const {
  const auto resolved = Resolve(names);
  if (!resolved) return tl::unexpected(resolved.error());
  std::vector<StopOrder> orders;
  for (const std::string& name : *resolved) {
    const StopOrder& last = robots_.at(name).stop;
    if (last.stopped == stopped) continue;
    orders.push_back({now, last.world, name, last.revision + 1, stopped, client, reason});
  }
  return orders;
}

Result<std::vector<StopOrder>> ControlRegistry::Stop(const std::string& client,
                                                     const StopRequest& request,
                                                     SimTime now) const {
  return SetStopped(request.robots, true, client, request.reason, now);
}

Result<std::vector<StopOrder>> ControlRegistry::Go(const std::string& client,
                                                   const GoRequest& request, SimTime now) const {
  return SetStopped(request.robots, false, client, "", now);
}

void ControlRegistry::Adopt(const StopOrder& order) {
  const auto found = robots_.find(order.robot);
  if (found == robots_.end()) return;
  found->second.stop = order;
  ++version_;
}

}  // namespace conav::operators
