#include "operator/supervision/control.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace conav::operators {
namespace {

bool IsHeldByOther(const ControlRegistry::Robot& robot, const std::string& client,
                   Clock::TimePoint now) {
  return !robot.holder.empty() && robot.holder != client && now < robot.held_until;
}

/// Whether our newest order may still be on its way to a robot that reports `revision`: it is not
/// older, nor so far ahead that the robot does not count it.
bool MayFollow(const StopOrder& ours, std::uint64_t revision) {
  return ours.revision >= revision && ours.revision - revision < kMaxCounterStep;
}

/// Of the next order: newer than the robot's and ours. Stays at the end of the range: 0 is no order.
std::uint64_t NextRevision(const StopOrder& ours, std::uint64_t reported) {
  const std::uint64_t newest = MayFollow(ours, reported) ? ours.revision : reported;
  return newest + (newest < std::numeric_limits<std::uint64_t>::max() ? 1 : 0);
}

/// A client that was silent for so long no longer repeats requests.
constexpr std::chrono::seconds kClientMemory{60};
/// A driver keeps the robot for so long after the last order (wall time).
constexpr std::chrono::seconds kDriverKept{5};
/// An order expires at most so far ahead (simulation time).
constexpr double kLongestValid = 5.0;     // s
constexpr double kQuickestCounts = 60.0;  // s

}  // namespace

std::string ClientNames::Claim(const std::string& client, const Writer& writer,
                               Clock::TimePoint now) {
  const auto known = owners_.find(client);
  if (known != owners_.end() && now < known->second.used_at + kKept) {
    if (known->second.is_own || known->second.writer != writer) {
      return fmt::format("the name {} belongs to another program", client);
    }
    known->second.used_at = now;
    return "";
  }
  std::erase_if(owners_, [&](const auto& entry) { return now >= entry.second.used_at + kKept; });
  const auto of_bus = [](const auto& entry) { return !entry.second.is_own; };
  const auto of_writer = [&](const auto& entry) {
    return of_bus(entry) && entry.second.writer == writer;
  };
  if (std::ranges::count_if(owners_, of_writer) >= static_cast<std::ptrdiff_t>(kMostOfWriter)) {
    return fmt::format("its program has {} other names; the limit", kMostOfWriter);
  }
  if (std::ranges::count_if(owners_, of_bus) >= static_cast<std::ptrdiff_t>(kMost)) {
    return fmt::format("there are {} other names; the limit", kMost);
  }
  owners_[client] = {writer, false, now};
  return "";
}

void ClientNames::ClaimOwn(const std::string& client, Clock::TimePoint now) {
  owners_[client] = {{}, true, now};
}

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
    if (!IsHeldByOther(robot, client, now)) continue;
    if (!request.ask && request.reason.empty()) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("{} has control of {}: say why you take over", robot.holder, name));
    }
    const bool others_ask = !robot.asked_by.empty() && robot.asked_by != client;
    if (request.ask && others_ask && now < robot.asked_until) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("{} asks for control of {} already", robot.asked_by, name));
    }
  }
  for (const std::string& name : *names) {
    Robot& robot = robots_.at(name);
    if (request.ask && IsHeldByOther(robot, client, now)) {
      robot.asked_by = client;
      robot.ask_reason = request.reason;
      robot.asked_until = now + kAskedFor;
    } else {
      Hold(robot, client, request.reason, now);
    }
  }
  ++version_;
  return {};
}

void ControlRegistry::Hold(Robot& robot, const std::string& client, const std::string& reason,
                           Clock::TimePoint now) {
  robot.holder = client;
  robot.reason = reason;
  robot.held_until = now + Seconds(options_.control_s);
  robot.asked_by.clear();
  robot.ask_reason.clear();
}

Result<void> ControlRegistry::Release(const std::string& client,
                                      const ReleaseControlRequest& request, Clock::TimePoint now) {
  const auto names = Resolve(request.robots);
  if (!names) return tl::unexpected(names.error());
  const std::string& next = request.to_client;
  for (const std::string& name : *names) {
    const Robot& robot = robots_.at(name);
    if (next.empty() || (robot.asked_by == next && now < robot.asked_until)) continue;
    return Fail(ErrorCode::kRefused,
                fmt::format("{} no longer asks for control of {}", next, name));
  }
  for (const std::string& name : *names) {
    Robot& robot = robots_.at(name);
    if (robot.holder == client) Free(robot, now);
  }
  return {};
}

void ControlRegistry::ReleaseAll(const std::string& client, Clock::TimePoint now) {
  for (auto& [name, robot] : robots_) {
    if (robot.asked_by == client) robot.asked_until = now;
    if (robot.holder == client) Free(robot, now);
  }
  Expire(now);
}

void ControlRegistry::Expire(Clock::TimePoint now) {
  for (auto& [name, robot] : robots_) {
    if (!robot.holder.empty() && now >= robot.held_until) Free(robot, now);
    if (robot.asked_by.empty() || now < robot.asked_until) continue;
    robot.asked_by.clear();
    robot.ask_reason.clear();
    ++version_;
  }
}

void ControlRegistry::Free(Robot& robot, Clock::TimePoint now) {
  const bool is_asked_for = !robot.asked_by.empty() && now < robot.asked_until;
  const std::string next = is_asked_for ? robot.asked_by : "";
  const std::string reason = is_asked_for ? robot.ask_reason : "";
  Hold(robot, next, reason, now);
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
    const Robot& robot = robots_.at(name);
    const bool may_move = !robot.stop.stopped && !robot.confirmed_stopped;
    if (!stopped && may_move) continue;
    const std::uint64_t revision = NextRevision(robot.stop, robot.confirmed_revision);
    orders.push_back({now, robot.world, name, revision, stopped, client, reason});
  }
  return orders;
}

Result<std::vector<StopOrder>> ControlRegistry::Stop(const std::string& client,
                                                     const StopRequest& request,
                                                     SimTime now) const {
  return SetStopped(request.robots, true, client, request.reason, now);
}

Result<std::vector<StopOrder>> ControlRegistry::Resume(const std::string& client,
                                                       const ResumeRequest& request,
                                                       SimTime now) const {
  return SetStopped(request.robots, false, client, "", now);
}

void ControlRegistry::Adopt(const StopOrder& order) {
  const auto found = robots_.find(order.robot);
  if (found == robots_.end()) return;
  found->second.stop = order;
  ++version_;
}

std::optional<StopOrder> ControlRegistry::Receive(const RobotState& state) {
  const auto found = robots_.find(state.robot);
  if (found == robots_.end() || found->second.world != state.world) return std::nullopt;
  Robot& robot = found->second;
  if (robot.confirmed_stopped != state.stopped || robot.confirmed_revision != state.stop_revision) {
    robot.confirmed_stopped = state.stopped;
    robot.confirmed_revision = state.stop_revision;
    ++version_;
  }
  if (!robot.stop.stopped || state.stopped || MayFollow(robot.stop, state.stop_revision)) {
    return std::nullopt;
  }
  StopOrder again = robot.stop;
  again.stamp = state.stamp;
  again.revision = NextRevision(robot.stop, state.stop_revision);
  return again;
}

DriveGate::DriveGate(const std::map<std::string, std::string>& world_of_robot) {
  for (const auto& [robot, world] : world_of_robot) robots_[robot].world = world;
}

void DriveGate::Receive(const RobotState& state) {
  const auto robot = robots_.find(state.robot);
  if (robot == robots_.end() || robot->second.world != state.world) return;
  robot->second.reported = true;
  robot->second.newest_order = std::max(robot->second.newest_order, state.drive_order);
}

std::string DriveGate::DriverOf(const std::string& name, Clock::TimePoint wall) const {
  const auto robot = robots_.find(name);
  if (robot == robots_.end() || wall >= robot->second.driven_at + kDriverKept) {
    return "";
  }
  return robot->second.driver;
}

std::optional<std::string> DriveGate::CheckAllowed(const OperatorRequest& request,
                                                   const DriveRequest& drive, SimTime now,
                                                   Clock::TimePoint wall) const {
  const auto robot = robots_.find(drive.robot);
  if (robot == robots_.end() || robot->second.world != request.world) {
    return fmt::format("robot {} is not in world {}", drive.robot, request.world);
  }
  if (!robot->second.reported) return fmt::format("robot {} has not reported yet", drive.robot);
  if (drive.expires_at <= now) {
    return fmt::format("expired at {:.3f} s, it is {:.3f} s", drive.expires_at.ToSeconds(),
                       now.ToSeconds());
  }
  const double valid_s = drive.expires_at.ToSeconds() - now.ToSeconds();
  if (valid_s > kLongestValid) {
    return fmt::format("valid for {:.3f} s; the limit is {} s", valid_s, kLongestValid);
  }
  const std::string driver = DriverOf(drive.robot, wall);
  if (!driver.empty() && driver != request.client && drive.drive != DriveAction::kStop) {
    return fmt::format("robot {} is steered by {}", drive.robot, driver);
  }
  return std::nullopt;
}

DriveGate::Answer DriveGate::Handle(const OperatorRequest& request, SimTime now,
                                    Clock::TimePoint wall) {
  const auto* drive = std::get_if<DriveRequest>(&request.body);
  DEMAND(drive != nullptr);
  ForgetOldClients(wall);
  Client& client = clients_[request.client];
  client.newest_at = wall;
  if (request.request_id == client.newest_request) return {client.reply, std::nullopt};
  Answer answer{Refusal(request, ""), std::nullopt};
  if (request.request_id < client.newest_request) {
    answer.reply.reason =
        fmt::format("older than request {} of this client", client.newest_request);
    return answer;
  }
  client.newest_request = request.request_id;
  if (auto reason = CheckAllowed(request, *drive, now, wall)) {
    answer.reply.reason = *std::move(reason);
  } else {
    Robot& robot = robots_.at(drive->robot);
    const std::string driver = DriverOf(drive->robot, wall);
    if (driver.empty() || driver == request.client) {
      robot.driver = request.client;
      robot.driven_at = wall;
    }
    answer.order = DriveOrder{now,          request.world,  drive->robot,     ++robot.newest_order,
                              drive->drive, request.client, drive->expires_at};
    answer.reply.accepted = true;
    answer.reply.revision = robot.newest_order;
  }
  client.reply = answer.reply;
  return answer;
}

void DriveGate::ForgetOldClients(Clock::TimePoint wall) {
  std::erase_if(clients_,
                [&](const auto& entry) { return wall - entry.second.newest_at > kClientMemory; });
}

bool RequestDelays::IsLate(const std::string& client, double published_s, double arrived_s) {
  std::erase_if(quickest_, [&](const auto& entry) {
    return std::abs(arrived_s - entry.second.arrived_s) > kQuickestCounts;
  });
  const double delay_s = arrived_s - published_s;
  Quickest& quickest = quickest_.try_emplace(client, Quickest{delay_s, arrived_s}).first->second;
  if (delay_s <= quickest.delay_s) quickest = {delay_s, arrived_s};
  return delay_s - quickest.delay_s > kLongestUnderWay;
}

const OperatorRequest* ReplacedBy(const std::vector<OperatorRequest>& requests, std::size_t index) {
  const OperatorRequest& request = requests[index];
  const auto* drive = std::get_if<DriveRequest>(&request.body);
  if (drive == nullptr) return nullptr;
  for (std::size_t i = requests.size(); i-- > 0;) {
    const OperatorRequest& later = requests[i];
    const auto* other = std::get_if<DriveRequest>(&later.body);
    if (other != nullptr && other->robot == drive->robot && later.client == request.client &&
        later.request_id > request.request_id) {
      return &later;
    }
  }
  return nullptr;
}

}  // namespace conav::operators
