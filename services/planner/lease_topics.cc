#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "planner/planner_service.h"

namespace conav::planner {
namespace {

constexpr std::chrono::milliseconds kFarewellLimit{300};

LeaseTable::Options OptionsFrom(const bus::Participant& participant, const PlannerConfig& config,
                                const std::map<std::string, std::string>& world_of_robot) {
  LeaseTable::Options options;
  options.node = participant.node_name();
  options.instance = UniqueId() + "-" + options.node.substr(0, 64);
  for (const auto& [robot, world] : world_of_robot) options.robots.push_back(robot);
  options.period = Seconds(config.lease.period_s);
  options.timeout = Seconds(config.lease.timeout_s);
  options.planners = config.lease.planners;
  return options;
}

}  // namespace

struct RobotLeases::PathTopics {
  PathTopics(bus::Participant& participant, const std::string& robot)
      : ours(participant, bus::kIntendedPath, robot),
        theirs(participant, bus::kIntendedPath, robot) {}

  bus::Publisher<conav_msgs::msg::IntendedPath> ours;
  bus::Subscriber<conav_msgs::msg::IntendedPath> theirs;
};

RobotLeases::RobotLeases(bus::Participant& participant, const PlannerConfig& config,
                         const std::map<std::string, std::string>& world_of_robot,
                         Blackboard& board, const Clock& clock)
    : board_(board),
      clock_(clock),
      table_(OptionsFrom(participant, config, world_of_robot), clock.Now()),
      announcements_(participant, bus::kPlannerLease),
      others_(participant, bus::kPlannerLease),
      announced_at_(clock.Now()) {
  for (const auto& [robot, world] : world_of_robot) {
    paths_[robot] = std::make_unique<PathTopics>(participant, robot);
    board_.PutLease(robot, {Lease::State::kNone, 0});
  }
}

RobotLeases::~RobotLeases() = default;

void RobotLeases::Receive(const RobotState& state) {
  table_.Receive(state.robot, state.lease_epoch, state.command_sequence_number, clock_.Now());
}

void RobotLeases::Turn() {
  const Clock::TimePoint now = clock_.Now();
  for (const PlannerLease& lease :
       others_.TakeValid([](const auto& message) { return ToDomain(message); })) {
    const auto received = table_.Receive(lease, now);
    if (received || !refusals_logged_.Allow()) continue;
    LOG_WARNING("lease refused", "planner", lease.node, "reason", received.error().text);
  }
  TakeReleases();
  Apply(table_.Turn(now));
  for (auto& [robot, topics] : paths_) {
    for (IntendedPath& wanted :
         topics->theirs.TakeValid([](const auto& message) { return ToDomain(message); })) {
      if (table_.EpochOf(robot) == 0) {
        board_.PutIntendedPath(robot, std::move(wanted.cells), std::move(wanted.room));
      }
    }
  }
  if (auto lease = table_.Announcement(now)) Announce(*std::move(lease), now);
}

void RobotLeases::TakeReleases() {
  for (const auto& [robot, topics] : paths_) {
    const bool given_up = board_.LeaseOf(robot).state == Lease::State::kNone;
    if (!given_up || table_.EpochOf(robot) == 0) continue;
    table_.Released(robot);
    LOG_INFO("robot handed over", "robot", robot);
  }
}

void RobotLeases::Apply(const LeaseTable::Changes& changes) {
  for (const std::string& node : changes.planners_gone) {
    LOG_WARNING("planner is silent, its robots are taken over", "planner", node);
  }
  for (const std::string& robot : changes.lost) {
    LOG_WARNING("another planner took the robot over", "robot", robot);
    board_.PutLease(robot, {Lease::State::kNone, 0});
  }
  for (const std::string& robot : changes.to_release) {
    board_.PutLease(robot, {Lease::State::kReleasing, table_.EpochOf(robot)});
  }
  for (const auto& taken : changes.taken) {
    LOG_INFO("robot taken", "robot", taken.robot, "lease_epoch", taken.lease_epoch);
    board_.PutLease(taken.robot, {Lease::State::kHeld, taken.lease_epoch});
  }
}

void RobotLeases::Announce(PlannerLease lease, Clock::TimePoint now) {
  const std::chrono::duration<double, std::micro> since = now - announced_at_;
  announced_at_ = now;
  const auto decided = static_cast<double>(decided_us_.exchange(0));
  lease.load = since.count() > 0.0 ? decided / since.count() : 0.0;
  bus::Send(announcements_, ToMessage(lease));
}

void RobotLeases::Leave() {
  Announce(table_.Farewell(), clock_.Now());
  announcements_.WaitForAcknowledgments(kFarewellLimit);
}

void RobotLeases::CountDecision(double duration_ms) {
  ++decisions_;
  decided_us_ += static_cast<std::int64_t>(duration_ms * 1e3);
}

void RobotLeases::PublishIntendedPath(const IntendedPath& path) {
  bus::Send(paths_.at(path.robot)->ours, ToMessage(path));
}

std::string RobotLeases::Describe(const std::string& robot) const {
  if (const auto epoch = table_.EpochOf(robot)) return fmt::format("lease epoch {}", epoch);
  const std::string driver = table_.DriverOf(robot);
  return "driven by " + (driver.empty() ? "no live planner" : driver);
}

int RobotLeases::held() const {
  return static_cast<int>(std::count_if(paths_.begin(), paths_.end(), [&](const auto& topics) {
    return table_.EpochOf(topics.first) != 0;
  }));
}

}  // namespace conav::planner
