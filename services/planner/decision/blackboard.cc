#include "planner/decision/blackboard.h"

#include <algorithm>
#include <cstdlib>

#include "common/grid/geometry.h"
#include "common/runtime/result.h"
#include "planner/decision/traffic.h"

namespace conav::planner {
namespace {

/// A robot on whose path it stands asks for room when it is so near (traffic.cc), and one more.
constexpr int kNear = 5;

int Distance(Cell a, Cell b) { return std::abs(a.row - b.row) + std::abs(a.column - b.column); }

/// Whether nothing but time has passed between two states of a robot.
bool IsSameButForTime(RobotState before, const RobotState& after) {
  before.stamp = after.stamp;
  before.heading_rad = after.heading_rad;
  before.position = after.position;
  before.speed_mps = after.speed_mps;
  before.yaw_rate_rps = after.yaw_rate_rps;
  before.distance_m = after.distance_m;
  before.camera_bytes = after.camera_bytes;
  return before == after;
}

/// The cell that a robot drives into.
std::optional<Cell> EnteredBy(const RobotState& state) {
  const bool enters = state.command_outcome == CommandOutcome::kRunning &&
                      AreNeighbours(state.cell, state.command_cell);
  return enters ? std::optional(state.command_cell) : std::nullopt;
}

}  // namespace

Blackboard::Blackboard(std::map<std::string, std::string> world_of_robot) {
  for (auto& [robot, world] : world_of_robot) robots_[robot].world = world;
}

Blackboard::Entry* Blackboard::FindLocked(const std::string& robot) {
  const auto entry = robots_.find(robot);
  return entry == robots_.end() ? nullptr : &entry->second;
}

struct Blackboard::Presence {
  std::vector<Cell> cells;  // where it stands, and into which it drives
  bool has_goals = false;
  bool is_driving = false;
  std::vector<Cell> path;
  RoomClaim room;
  bool operator==(const Presence&) const = default;
};

Blackboard::Presence Blackboard::PresenceOf(const Entry& entry) {
  Presence presence;
  presence.path = entry.path;
  presence.room = entry.room;
  if (!entry.inputs.state) return presence;
  presence.cells = {entry.inputs.state->cell};
  if (const auto cell = EnteredBy(*entry.inputs.state)) presence.cells.push_back(*cell);
  presence.has_goals = !entry.inputs.state->goals_left.empty();
  presence.is_driving = entry.inputs.state->command_outcome == CommandOutcome::kRunning;
  return presence;
}

void Blackboard::ChangedLocked(Entry& entry, bool is_cause) {
  ++entry.version;
  if (is_cause) ++entry.inputs.causes;
  entry.changed.notify_all();
}

void Blackboard::ChangedForOthersLocked(const Entry& changed, const Presence& before) {
  const Presence after = PresenceOf(changed);
  if (before == after) return;
  // A robot's rank depends on whether it has a path and goals.
  const bool keeps_rank =
      before.has_goals == after.has_goals && before.path.empty() == after.path.empty();
  std::vector<Cell> stands;  // where others may be in the way of a decision
  std::vector<Cell> claims;  // and for which they may have to make room
  const auto add = [](std::vector<Cell>& to, const std::vector<Cell>& cells) {
    to.insert(to.end(), cells.begin(), cells.end());
  };
  for (const auto& [side, other] : {std::pair(&before, &after), std::pair(&after, &before)}) {
    if (!keeps_rank || side->cells != other->cells || side->is_driving != other->is_driving) {
      add(stands, side->cells);
    }
    if (side->room != other->room) {
      add(side->room.right.tier == RightOfWay::kShutIn ? stands : claims, side->room.cells);
    }
    for (const Cell cell : side->path) {
      if (!keeps_rank || !Contains(other->path, cell)) claims.push_back(cell);
    }
  }
  for (auto& named : robots_) {
    Entry& entry = named.second;
    const auto& state = entry.inputs.state;
    if (&entry == &changed || entry.world != changed.world || !state) continue;
    if (state->command_outcome == CommandOutcome::kRunning) continue;
    const auto is_near = [&](Cell cell) { return Distance(cell, state->cell) <= kNear; };
    const auto is_in_its_way = [&](Cell cell) {
      const auto ahead = entry.path.begin() + std::min(kLookAhead, std::ssize(entry.path));
      return Distance(cell, state->cell) <= 1 ||
             std::any_of(entry.path.begin(), ahead,
                         [&](Cell own) { return Distance(cell, own) <= 1; });
    };
    const bool is_cause = std::ranges::any_of(stands, is_in_its_way);
    const bool concerns =
        is_cause || std::ranges::any_of(stands, is_near) || std::ranges::any_of(claims, is_near);
    if (concerns) ChangedLocked(entry, is_cause);
  }
}

template <class Apply>
void Blackboard::Change(const std::string& robot, Apply&& apply) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr) return;
  apply(*entry);
  ChangedLocked(*entry);
}

void Blackboard::Put(RobotState state) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(state.robot);
  if (entry == nullptr) return;
  const Presence before = PresenceOf(*entry);
  const auto& old = entry->inputs.state;
  const bool is_cause = !old || !IsSameButForTime(*old, state);
  entry->inputs.state = std::move(state);
  ChangedLocked(*entry, is_cause);
  ChangedForOthersLocked(*entry, before);
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
    ChangedLocked(entry);
  }
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
  ChangedLocked(*entry);
}

void Blackboard::Put(StopOrder order) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(order.robot);
  if (entry == nullptr || entry->world != order.world) return;
  entry->inputs.stop_order = std::move(order);
  ChangedLocked(*entry);
}

void Blackboard::PutTruth(const std::string& world, const OccupancyGrid& truth) {
  const std::lock_guard lock(mutex_);
  for (auto& [robot, entry] : robots_) {
    if (entry.world != world) continue;
    entry.inputs.truth = truth;
    ChangedLocked(entry);
  }
}

void Blackboard::PutLens(const std::string& robot, const CameraLens& lens) {
  const std::lock_guard lock(mutex_);
  Entry* entry = FindLocked(robot);
  if (entry == nullptr || entry->inputs.lens == lens) return;  // comes with every image
  entry->inputs.lens = lens;
  ChangedLocked(*entry);
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
  const Presence before = PresenceOf(*entry);
  entry->path = std::move(path);
  entry->room = std::move(room);
  ChangedForOthersLocked(*entry, before);
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
  ChangedLocked(*entry);
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
                          .is_driving = state.command_outcome == CommandOutcome::kRunning,
                          .entering = EnteredBy(state)});
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

std::uint64_t Blackboard::version(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return robots_.at(robot).version;
}

std::uint64_t Blackboard::WaitForChange(const std::string& robot, std::uint64_t seen,
                                        Clock::TimePoint deadline) const {
  std::unique_lock lock(mutex_);
  const Entry& entry = robots_.at(robot);
  entry.changed.wait_until(lock, deadline, [&] { return entry.version != seen; });
  return entry.version;
}

void Blackboard::Touch() {
  const std::lock_guard lock(mutex_);
  for (auto& [robot, entry] : robots_) ChangedLocked(entry);
}

}  // namespace conav::planner
