#include "planner/decision/blackboard.h"

#include <algorithm>

#include "common/runtime/result.h"

namespace conav::planner {

Blackboard::Blackboard(std::map<std::string, std::string> world_of_robot) {
  for (auto& [robot, world] : world_of_robot) robots_[robot].world = world;
}

Blackboard::Entry* Blackboard::FindLocked(const std::string& robot) {
  const auto entry = robots_.find(robot);
  return entry == robots_.end() ? nullptr : &entry->second;
}

void Blackboard::ChangedLocked() {
  ++version_;
  changed_.notify_all();
}

template <class Apply>
void Blackboard::Change(const std::string& robot, Apply&& apply) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr) return;
  apply(*entry);
  ChangedLocked();
}

void Blackboard::Put(RobotState state) {
  Change(state.robot, [&](Entry& entry) { entry.inputs.state = std::move(state); });
}

void Blackboard::PutMap(const std::string& robot, MapUpdate map) {
  Change(robot, [&](Entry& entry) { entry.inputs.map = std::move(map); });
}

void Blackboard::Put(const Belief& belief) {
  const std::lock_guard lock(mutex_);
  for (auto& [robot, entry] : robots_) {
    if (entry.world != belief.world) continue;
    // The operator service restarted without its database: the old guidance no longer counts.
    if (entry.inputs.belief && belief.revision < entry.inputs.belief->revision) {
      entry.inputs.guidance.reset();
      if (entry.inputs.route_status.stage == RouteStatus::Stage::kTaken) {
        entry.inputs.route_status.stage = RouteStatus::Stage::kReplaced;
      }
    }
    entry.inputs.belief = belief;
  }
  ChangedLocked();
}

void Blackboard::Put(Guidance guidance) {
  Change(guidance.robot, [&](Entry& entry) {
    const bool is_open = entry.inputs.route_status.stage <= RouteStatus::Stage::kTaken;
    if (is_open) entry.inputs.route_status.stage = RouteStatus::Stage::kReplaced;
    entry.inputs.route.reset();
    entry.inputs.guidance = std::move(guidance);
  });
}

void Blackboard::Put(DriveOrder order) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(order.robot);
  if (entry == nullptr || entry->world != order.world) return;
  entry->inputs.drive = std::move(order);
  ChangedLocked();
}

void Blackboard::Put(StopOrder order) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(order.robot);
  if (entry == nullptr || entry->world != order.world) return;
  entry->inputs.stop_order = std::move(order);
  ChangedLocked();
}

void Blackboard::PutTruth(const std::string& world, const OccupancyGrid& truth) {
  const std::lock_guard lock(mutex_);
  for (auto& [robot, entry] : robots_) {
    if (entry.world == world) entry.inputs.truth = truth;
  }
  ChangedLocked();
}

void Blackboard::PutLens(const std::string& robot, const CameraLens& lens) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr || entry->inputs.lens == lens) return;  // comes with every image
  entry->inputs.lens = lens;
  ChangedLocked();
}

std::uint64_t Blackboard::PutRoute(const std::string& robot, std::vector<Position> positions) {
  std::uint64_t number = 0;
  Change(robot, [&](Entry& entry) {
    number = entry.inputs.route_status.number + 1;
    entry.inputs.route_status = {.number = number, .reason = {}};
    entry.inputs.route = Route{number, std::move(positions)};
  });
  return number;
}

bool Blackboard::PutIntendedPath(const std::string& robot, std::vector<Cell> path, RoomClaim room) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr || (entry->path == path && entry->room == room)) return false;
  entry->path = std::move(path);
  entry->room = std::move(room);
  ChangedLocked();
  return true;
}

void Blackboard::PutBlockedReason(const std::string& robot, std::string_view reason) {
  const std::lock_guard lock(mutex_);
  if (Entry* entry = FindLocked(robot)) entry->blocked_reason = reason;
}

std::string_view Blackboard::BlockedReasonOf(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return robots_.at(robot).blocked_reason;
}

void Blackboard::PutLease(const std::string& robot, Lease lease) {
  Change(robot, [&](Entry& entry) { entry.inputs.lease = lease; });
}

Lease Blackboard::LeaseOf(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return robots_.at(robot).inputs.lease;
}

void Blackboard::GiveUp(const std::string& robot, Lease lease) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr || entry->inputs.lease != lease) return;
  entry->inputs.lease = {Lease::State::kNone, 0};
  ChangedLocked();
}

void Blackboard::ReceivedAttention(const std::string& robot, std::uint64_t sequence_number) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry != nullptr) entry->attentions = std::max(entry->attentions, sequence_number);
}

std::uint64_t Blackboard::NextAttention(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  return ++robots_.at(robot).attentions;
}

void Blackboard::ResolveRoute(const std::string& robot, std::uint64_t number,
                              Result<Guidance> guidance) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr || !entry->inputs.route || entry->inputs.route->number != number) return;
  entry->inputs.route.reset();
  if (!guidance) {
    entry->inputs.route_status.stage = RouteStatus::Stage::kRefused;
    entry->inputs.route_status.reason = guidance.error().text;
    return;
  }
  entry->inputs.route_status.stage = RouteStatus::Stage::kTaken;
  entry->inputs.route_status.end = guidance->path.back();
  entry->inputs.guidance = *std::move(guidance);
}

void Blackboard::FinishRoute(const std::string& robot) {
  Change(robot, [](Entry& entry) {
    if (entry.inputs.route_status.stage != RouteStatus::Stage::kTaken) return;
    entry.inputs.route_status.stage = RouteStatus::Stage::kReached;
    entry.inputs.guidance->path.clear();
  });
}

void Blackboard::CancelRoute(const std::string& robot, std::uint64_t number) {
  Change(robot, [&](Entry& entry) {
    if (entry.inputs.route_status.number != number) return;
    entry.inputs.route.reset();
    if (entry.inputs.route_status.stage == RouteStatus::Stage::kTaken)
      entry.inputs.guidance->path.clear();
    entry.inputs.route_status.stage = RouteStatus::Stage::kRefused;
    entry.inputs.route_status.reason = "canceled";
  });
}

RouteStatus Blackboard::RouteStatusOf(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return robots_.at(robot).inputs.route_status;
}

RobotInputs Blackboard::Read(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  const auto entry = robots_.find(robot);
  DEMAND(entry != robots_.end(), robot);
  RobotInputs inputs = entry->second.inputs;
  if (!inputs.state) return inputs;
  for (const auto& [name, other] : robots_) {
    const auto& state = other.inputs.state;
    if (other.world != entry->second.world || !state || state->grid.rows == 0) continue;
    if (!AreAligned(state->grid, inputs.state->grid)) inputs.misaligned = name;
  }
  return inputs;
}

std::vector<Neighbour> Blackboard::NeighboursOf(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  std::vector<Neighbour> neighbours;
  const std::string& world = robots_.at(robot).world;
  for (const auto& [name, entry] : robots_) {
    if (name == robot || entry.world != world || !entry.inputs.state) continue;
    const RobotState& state = *entry.inputs.state;
    neighbours.push_back({.robot = name,
                          .cell = state.cell,
                          .has_goals = !state.goals_left.empty(),
                          .path = entry.path,
                          .room = entry.room,
                          .is_driving = state.command_outcome == CommandOutcome::kRunning});
  }
  return neighbours;
}

SimTime Blackboard::NewestStamp(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  const std::string& world = robots_.at(robot).world;
  SimTime newest;
  for (const auto& [name, entry] : robots_) {
    if (entry.world == world && entry.inputs.state)
      newest = std::max(newest, entry.inputs.state->stamp);
  }
  return newest;
}

std::uint64_t Blackboard::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

std::uint64_t Blackboard::WaitForChange(std::uint64_t seen, Clock::TimePoint deadline) const {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [&] { return version_ != seen; });
  return version_;
}

void Blackboard::Touch() {
  const std::lock_guard lock(mutex_);
  ChangedLocked();
}

}  // namespace conav::planner
