#include "operator/supervision/drive_gate.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/runtime/result.h"

namespace conav::operators {
namespace {

/// A client that was silent for so long no longer repeats requests.
constexpr std::chrono::seconds kClientMemory{60};

}  // namespace

DriveGate::DriveGate(std::map<std::string, std::string> world_of_robot, DriveGateOptions options)
    : options_(options) {
  for (auto& [robot, world] : world_of_robot) robots_[robot].world = world;
}

void DriveGate::Receive(const RobotState& state) {
  const auto robot = robots_.find(state.robot);
  if (robot == robots_.end() || robot->second.world != state.world) return;
  robot->second.reported = true;
  robot->second.newest_order = std::max(robot->second.newest_order, state.drive_order);
}

std::string DriveGate::DriverOf(const std::string& name, Clock::TimePoint wall) const {
  const auto robot = robots_.find(name);
  if (robot == robots_.end() || wall >= robot->second.driven_at + Seconds(options_.hold_s)) {
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
  if (valid_s > options_.longest_valid_s) {
    return fmt::format("valid for {:.3f} s; the limit is {} s", valid_s, options_.longest_valid_s);
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
