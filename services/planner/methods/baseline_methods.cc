#include "planner/methods/baseline_methods.h"

#include <algorithm>

#include "planner/decision/traffic.h"

namespace conav::planner {

Decision StandOff::WaitOrStepOut(const Situation& situation, const std::vector<Cell>& path) {
  if (patience_.Holds(InTheWay(situation, path))) return patience_.Wait();
  patience_.End();
  if (const auto cell = StepAnywhere(situation, random_)) return MoveAlong({*cell});
  return {};
}

namespace {

Decision Ask(AttentionReason reason, Cell cell) {
  Decision decision;
  decision.attention = reason;
  decision.attention_cell = cell;
  return decision;
}

}  // namespace

bool PathFollower::Locate(const Situation& situation) {
  if (!situation.guidance) return false;
  const Guidance& guidance = *situation.guidance;
  if (path_ != guidance.path) stand_off_.End();
  // A goal pose keeps the revision, not the stamp.
  if (path_ != guidance.path || revision_ != guidance.revision || stamp_ != guidance.stamp) {
    path_ = guidance.path;
    revision_ = guidance.revision;
    stamp_ = guidance.stamp;
    position_ = 0;
  }
  const auto from = path_.begin() + static_cast<std::ptrdiff_t>(position_);
  const auto at = std::find(from, path_.end(), situation.state.cell);
  if (at == path_.end()) return false;
  position_ = static_cast<std::size_t>(at - path_.begin());
  return true;
}

std::vector<Cell> PathFollower::Rest(const Situation& situation) {
  if (situation.state.goals_left.empty() || !Locate(situation)) return {};
  return {path_.begin() + static_cast<std::ptrdiff_t>(position_) + 1, path_.end()};
}

Decision PathFollower::Next(const Situation& situation) {
  Decision decision = FollowOrAsk(situation);
  if (decision.action || decision.attention) {
    stand_off_.End();
    return decision;
  }
  return stand_off_.WaitOrStepOut(situation, Rest(situation));
}

Decision PathFollower::FollowOrAsk(const Situation& situation) {
  std::vector<Cell> rest = Rest(situation);
  if (rest.empty()) return Ask(AttentionReason::kNoGuidance, situation.state.cell);
  const Cell next = rest.front();
  if (IsKnownWall(situation.map.cells, next)) return Ask(AttentionReason::kBlocked, next);
  if (IsTaken(situation, next) || WaitsFor(situation, rest) != nullptr) return {};
  return MoveAlong(std::move(rest));
}

Decision InstructionMethod::Decide(const Situation& situation, const StopToken&) {
  if (situation.state.goals_left.empty()) return {};
  return follower_.Next(situation);
}

std::vector<Cell> InstructionMethod::IntendedPathFor(const Situation& situation) {
  return follower_.Rest(situation);
}

Decision TeleopMethod::Decide(const Situation& situation, const StopToken&) {
  Decision decision;
  const auto& order = situation.drive;
  // The robot itself may have carried it out for a planner that is gone.
  if (!order || order->sequence_number == newest_order_ ||
      order->sequence_number == situation.state.drive_order) {
    return decision;
  }
  newest_order_ = order->sequence_number;
  if (order->expires_at <= situation.now) return decision;
  Action& action = decision.action.emplace();
  action.kind = CommandKind::kDrive;
  action.target = situation.state.cell;
  action.drive = order->drive;
  action.drive_order = order->sequence_number;
  action.expires_at = order->expires_at;
  return decision;
}

GreedyMethod::GreedyMethod(std::uint64_t seed, const Clock& clock,
                           const std::optional<RegionOptions>& regions)
    : stand_off_(seed, clock) {
  if (!regions) return;
  no_views_ = std::make_shared<const GridViews>(GridViews::Options{.headings = 0});
  regions_.emplace(*regions);
}

void GreedyMethod::Prepare(const OccupancyGrid& map) {
  if (regions_) regions_->Prepare(map);
}

Decision GreedyMethod::DecideOnRegions(const Situation& situation) {
  regions_->Update(situation, no_views_);
  if (auto decision = regions_->ApproachGoal(situation)) return *std::move(decision);
  const std::vector<Cell> way = regions_->WayToGoal(situation);
  if (!way.empty()) {
    stand_off_.End();
    return regions_->MoveAlong(situation, way);
  }
  return situation.neighbours.empty() ? Decision{} : stand_off_.WaitOrStepOut(situation, way);
}

Decision GreedyMethod::Decide(const Situation& situation, const StopToken&) {
  if (regions_) return DecideOnRegions(situation);
  std::vector<Cell> path = DesiredPath(situation);
  if (path.empty()) return {};
  if (IsTaken(situation, path.front()) || WaitsFor(situation, path) != nullptr) {
    return stand_off_.WaitOrStepOut(situation, path);
  }
  stand_off_.End();
  return MoveAlong(std::move(path));
}

std::vector<Cell> GreedyMethod::IntendedPathFor(const Situation& situation) {
  return DesiredPath(situation);
}

namespace {

Decision SendSnapshot(Cell cell, double heading_rad) {
  Decision decision;
  decision.action = Action{CommandKind::kTransmitView, cell, heading_rad};
  decision.report.actions.push_back({.kind = CommandKind::kTransmitView,
                                     .target = cell,
                                     .heading_rad = heading_rad,
                                     .visits = 1});
  decision.report.chosen = 0;
  return decision;
}

bool IsAnswered(const Situation& situation) {
  return situation.state.snapshots <= situation.answered_snapshot &&
         situation.belief.revision >= situation.answered_belief;
}

}  // namespace

bool MappingMethod::HasTask(const Situation& situation) {
  const RobotState& state = situation.state;
  if (task_ && state.snapshots > task_->snapshots_before) task_.reset();
  if (!situation.truth || !IsAnswered(situation)) return false;
  if (!tour_) tour_.emplace(state.goals_left, MappingTourOptions{}, seed_);
  if (!task_) {
    task_ = {tour_->Next(*situation.truth, situation.belief.wall_probability, state.cell),
             state.snapshots};
  }
  return true;
}

Decision MappingMethod::Decide(const Situation& situation, const StopToken&) {
  if (!HasTask(situation)) return {};
  const Cell here = situation.state.cell;
  if (here == task_->stop.cell) return SendSnapshot(here, task_->stop.heading_rad);
  std::vector<Cell> path = IntendedPathFor(situation);
  if (path.empty()) {  // shut out by a step aside: there is always another stop
    task_.reset();
    Decision soon;
    soon.again = Clock::TimePoint::min();
    return soon;
  }
  if (IsTaken(situation, path.front()) || WaitsFor(situation, path) != nullptr) {
    return stand_off_.WaitOrStepOut(situation, path);
  }
  stand_off_.End();
  return MoveAlong(std::move(path));
}

std::vector<Cell> MappingMethod::IntendedPathFor(const Situation& situation) {
  if (!task_ || !situation.truth) return {};
  const OccupancyGrid& truth = *situation.truth;
  return PathToNearest(
      truth, situation.state.cell, [&](Cell cell) { return truth[cell] == Occupancy::kFree; },
      [&](Cell cell) { return cell == task_->stop.cell; });
}

}  // namespace conav::planner
