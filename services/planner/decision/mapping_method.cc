#include "planner/decision/mapping_method.h"

#include "planner/decision/traffic.h"
#include "planner/decision/way_to_nearest.h"

namespace conav::planner {
namespace {

Decision SendPicture(Cell cell, double heading_rad) {
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

bool MappingMethod::HasErrand(const Situation& situation) {
  const RobotState& state = situation.state;
  if (errand_ && state.snapshots > errand_->snapshots_before) errand_.reset();
  if (!situation.truth || !IsAnswered(situation)) return false;
  if (!tour_) tour_.emplace(state.goals_left, MappingTourOptions{}, seed_);
  if (!errand_) {
    errand_ = {tour_->Next(*situation.truth, situation.belief.wall_probability, state.cell),
               state.snapshots};
  }
  return true;
}

Decision MappingMethod::Decide(const Situation& situation, const StopToken&) {
  if (!HasErrand(situation)) return {};
  const Cell here = situation.state.cell;
  if (here == errand_->stop.cell) return SendPicture(here, errand_->stop.heading_rad);
  std::vector<Cell> way = WayFor(situation);
  if (way.empty()) {  // shut out by a step aside: there is always another stop
    errand_.reset();
    return {};
  }
  if (IsTaken(situation, way.front()) || WaitsFor(situation, way) != nullptr) {
    return stand_off_.WaitOrStepOut(situation);
  }
  stand_off_.End();
  return MoveAlong(std::move(way));
}

std::vector<Cell> MappingMethod::WayFor(const Situation& situation) {
  if (!errand_ || !situation.truth) return {};
  const OccupancyGrid& truth = *situation.truth;
  return WayToNearest(
      truth, situation.state.cell, [&](Cell cell) { return truth[cell] == Occupancy::kFree; },
      [&](Cell cell) { return cell == errand_->stop.cell; });
}

}  // namespace conav::planner
