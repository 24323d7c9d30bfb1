#include "planner/decision/leases.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/msg/supervision.h"

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

LeaseTable::LeaseTable(Options options, TimePoint now)
    : options_(std::move(options)), started_(now), last_turn_(now) {
  for (const std::string& robot : options_.robots) robots_[robot] = {};
}

Result<void> LeaseTable::Receive(const PlannerLease& lease, TimePoint now) {
  if (lease.instance == options_.instance) return {};
  for (const PlannerLease::Held& held : lease.holds) {
    const auto robot = robots_.find(held.robot);
    if (robot == robots_.end() || held.lease_epoch <= robot->second.highest_epoch) continue;
    if (held.lease_epoch - robot->second.highest_epoch <= kMaxCounterStep) continue;
    return Fail(ErrorCode::kRefused,
                fmt::format("lease epoch {} of {} is more than {} ahead of {}", held.lease_epoch,
                            held.robot, kMaxCounterStep, robot->second.highest_epoch));
  }
  const auto holds = [&](const PlannerLease::Held& before) {
    return std::find(lease.holds.begin(), lease.holds.end(), before) != lease.holds.end();
  };
  if (const auto other = others_.find(lease.instance); other != others_.end()) {
    for (const PlannerLease::Held& before : other->second.lease.holds) {
      const auto robot = robots_.find(before.robot);
      if (robot == robots_.end() || holds(before)) continue;
      robot->second.released_epoch = std::max(robot->second.released_epoch, before.lease_epoch);
    }
  }
  for (const PlannerLease::Held& held : lease.holds) {
    const auto robot = robots_.find(held.robot);
    if (robot == robots_.end()) continue;
    robot->second.highest_epoch = std::max(robot->second.highest_epoch, held.lease_epoch);
  }
  changed_ = true;
  if (lease.leaving) {
    others_.erase(lease.instance);
  } else {
    others_[lease.instance] = {lease, now};
  }
  return {};
}

void LeaseTable::Receive(const std::string& name, std::uint64_t lease_epoch,
                         std::uint64_t command_sequence_number, TimePoint now) {
  const auto found = robots_.find(name);
  if (found == robots_.end()) return;
  Robot& robot = found->second;
  const bool same =
      robot.shown_epoch == lease_epoch && robot.shown_sequence_number == command_sequence_number;
  if (same && robot.has_reported) return;
  changed_ = changed_ || !robot.has_reported || robot.shown_epoch != lease_epoch;
  robot.has_reported = true;
  robot.shown_epoch = lease_epoch;
  robot.shown_sequence_number = command_sequence_number;
  robot.highest_epoch = std::max(robot.highest_epoch, lease_epoch);
  if (robot.epoch == 0 || lease_epoch != robot.epoch) robot.foreign_command = now;
}

void LeaseTable::Released(const std::string& name) {
  const auto found = robots_.find(name);
  DEMAND(found != robots_.end(), name);
  Robot& robot = found->second;
  if (robot.epoch == 0) return;
  robot.released_epoch = std::max(robot.released_epoch, robot.epoch);
  robot.epoch = 0;
  robot.releasing = false;
  changed_ = true;
}

LeaseTable::Changes LeaseTable::Turn(TimePoint now) {
  Changes changes;
  ForgiveAfterPause(now);
  if (!changed_ && now - looked_at_ < options_.period / 4) return changes;
  changed_ = false;
  looked_at_ = now;
  ForgetSilent(now, changes);
  GiveUpLost(changes);
  if (!StillGathering(now)) Rebalance(now, changes);
  return changes;
}

void LeaseTable::ForgiveAfterPause(TimePoint now) {
  const bool paused = now - last_turn_ > options_.timeout / 2;
  last_turn_ = now;
  if (!paused) return;
  for (auto& [instance, other] : others_) other.received_at = now;
  for (auto& [name, robot] : robots_) robot.foreign_command = now;
}

void LeaseTable::ForgetSilent(TimePoint now, Changes& changes) {
  for (auto other = others_.begin(); other != others_.end();) {
    if (now - other->second.received_at < options_.timeout) {
      ++other;
      continue;
    }
    changes.planners_gone.push_back(other->second.lease.node);
    other = others_.erase(other);
  }
}

void LeaseTable::GiveUpLost(Changes& changes) {
  const Holders holders = FindHolders();
  for (auto& [name, robot] : robots_) {
    if (robot.epoch == 0) continue;
    const bool ours = holders.at(name).second == options_.instance;
    if (ours && robot.shown_epoch <= robot.epoch) continue;
    robot.epoch = 0;
    robot.releasing = false;
    changes.lost.push_back(name);
  }
}

bool LeaseTable::StillGathering(TimePoint now) {
  const bool all_there = live_planners() >= options_.planners;
  gathered_ = gathered_ || all_there || now - started_ >= options_.timeout;
  return !gathered_;
}

void LeaseTable::Rebalance(TimePoint now, Changes& changes) {
  const Holders holders = FindHolders();
  const auto assignment = AssignRobots(Members(holders));
  for (auto& [name, robot] : robots_) {
    const bool ours = assignment.at(name) == options_.instance;
    if (!ours && robot.epoch != 0 && !robot.releasing) {
      robot.releasing = true;
      changes.to_release.push_back(name);
    }
    if (!ours || holders.contains(name) || !MayTake(robot, now)) continue;
    robot.epoch = ++robot.highest_epoch;
    changes.taken.push_back({name, robot.epoch});
  }
}

bool LeaseTable::MayTake(const Robot& robot, TimePoint now) const {
  if (!robot.has_reported) return false;
  const bool free = robot.shown_epoch <= robot.released_epoch;
  return free || now - robot.foreign_command >= options_.timeout;
}

LeaseTable::Holders LeaseTable::FindHolders() const {
  Holders holders;
  for (const auto& [name, robot] : robots_) {
    if (robot.epoch != 0) holders[name] = {robot.epoch, options_.instance};
  }
  for (const auto& [instance, other] : others_) {
    for (const PlannerLease::Held& held : other.lease.holds) {
      auto& holder = holders[held.robot];
      holder = std::max(holder, std::pair(held.lease_epoch, instance));
    }
  }
  return holders;
}

std::vector<Member> LeaseTable::Members(const Holders& holders) const {
  std::map<std::string, Member> members;
  members[options_.instance].robots.insert(options_.robots.begin(), options_.robots.end());
  for (const auto& [instance, other] : others_) {
    members[instance].robots.insert(other.lease.robots.begin(), other.lease.robots.end());
  }
  for (const auto& [robot, holder] : holders) members[holder.second].holds.insert(robot);
  std::vector<Member> list;
  for (auto& [instance, member] : members) {
    member.instance = instance;
    list.push_back(std::move(member));
  }
  return list;
}

PlannerLease LeaseTable::Ours() const {
  PlannerLease lease;
  lease.node = options_.node;
  lease.instance = options_.instance;
  lease.robots = options_.robots;
  for (const auto& [name, robot] : robots_) {
    if (robot.epoch != 0) lease.holds.push_back({name, robot.epoch});
  }
  return lease;
}

std::optional<PlannerLease> LeaseTable::Announcement(TimePoint now) {
  PlannerLease lease = Ours();
  if (announced_ == lease && now - announced_at_ < options_.period) return std::nullopt;
  announced_ = lease;
  announced_at_ = now;
  return lease;
}

PlannerLease LeaseTable::Farewell() {
  for (auto& [name, robot] : robots_) Released(name);
  PlannerLease lease = Ours();
  lease.leaving = true;
  return lease;
}

std::string LeaseTable::DriverOf(const std::string& robot) const {
  const Holders holders = FindHolders();
  const auto holder = holders.find(robot);
  if (holder == holders.end()) return "";
  if (holder->second.second == options_.instance) return options_.node;
  return others_.at(holder->second.second).lease.node;
}

std::uint64_t LeaseTable::EpochOf(const std::string& robot) const {
  return robots_.at(robot).epoch;
}

}  // namespace conav::planner
