#include "robot/driver/driver.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace conav::robot {
namespace {

constexpr double kLeastToleranceM = 0.05;
constexpr double kDriveStepS = 0.25;
/// Least way or turn in stuck_s that counts as progress.
constexpr double kProgress = 0.05;
constexpr std::string_view kOccupiedWay = "another robot is on the way";
constexpr double kLookAheadM = 0.3;  // of a drive step, besides the robot's radius
constexpr auto kMapRefresh = std::chrono::seconds(1);

}  // namespace

Driver::Driver(const DriverOptions& options, std::unique_ptr<Mover> mover, Pan pan)
    : options_(options), mover_(std::move(mover)), pan_(std::move(pan)), gate_(options.robot) {
  state_.world = options.world;
  state_.robot = options.robot;
}

// --- what came in --------------------------------------------------------------------------------

void Driver::SetGrid(const GridGeometry& grid) {
  if (!keeper_) keeper_.emplace(grid, options_.map);
}

void Driver::Receive(RobotMap map, Clock::TimePoint now) {
  map_received_ = now;
  keeper_->Receive(std::move(map));
  map_stale_ = true;
}

void Driver::Locate(const std::optional<Pose>& place, const std::string& problem, double speed_mps,
                    double turn_rps) {
  location_problem_ = problem;
  if (!place || !keeper_) return;
  const GridGeometry& grid = keeper_->grid();
  const Cell cell = grid.PositionToCell(place->position);
  if (!grid.Contains(cell)) {
    if (!problem.empty()) return;
    location_problem_ = fmt::format("it stands at ({:.1f}, {:.1f}) m, outside of the plan",
                                    place->position.x_m, place->position.y_m);
    return;
  }
  if (place_ && problem.empty()) state_.distance_m += Distance(place_->position, place->position);
  place_ = place;
  state_.position = place->position;
  state_.heading_rad = place->heading_rad;
  state_.speed_mps = speed_mps;
  state_.yaw_rate_rps = turn_rps;
  keeper_->Stand(cell);
  if (state_.path.empty()) {
    state_.cell = cell;
    state_.path = {cell};
    state_.command_cell = cell;
  }
  if (map_ && map_->cells[cell] != Occupancy::kFree) map_stale_ = true;
}

Result<void> Driver::Receive(const RobotCommand& command, SimTime now) {
  now_ = std::max(now_, now);
  const bool was_active = gate_.active();
  const auto admission = gate_.Receive(command, now);
  if (!admission) return tl::unexpected(admission.error());
  if (*admission == CommandGate::Admission::kRepeated) return {};
  if (was_active && place_) mover_->Cancel(*place_);
  phase_ = Phase::kIdle;
  picture_since_.reset();
  held_at_.reset();
  waits_since_.reset();
  if (!keeper_ || !place_) {
    if (gate_.active()) gate_.End(CommandOutcome::kRefused, Problem());
    return {};
  }
  NoteCell();
  if (gate_.active()) BeginCommand();
  return {};
}

void Driver::Receive(const StopOrder& order) {
  if (!gate_.Receive(order)) return;
  if (place_) mover_->Cancel(*place_);
  Finish(CommandOutcome::kStopped, "a person has stopped the robot");
}

void Driver::Receive(Picture picture, const DepthProfile& depth, SimTime now) {
  now_ = std::max(now_, now);
  const GridGeometry& grid = keeper_->grid();
  const Pose at{place_->position, WrapAngle(place_->heading_rad + pan_rad_)};
  NoteCell();
  Snapshot snapshot{.stamp = now_,
                    .world = options_.world,
                    .robot = options_.robot,
                    .sequence_number = ++state_.snapshots,
                    .grid = grid,
                    .cell = state_.cell,
                    .position = at.position,
                    .heading_rad = at.heading_rad,
                    .horizontal_fov_rad = lens_->horizontal_fov_rad,
                    .width = picture.width,
                    .height = picture.height,
                    .jpeg = std::move(picture.jpeg)};
  snapshot.visible = Recognise(keeper_->Known(wall_), grid, *lens_, options_.view, at, depth);
  snapshot.path = state_.path;
  ++state_.images;
  state_.image_bytes += snapshot.jpeg.size();
  state_.path = {state_.cell};
  snapshot_ = std::move(snapshot);
  Finish(CommandOutcome::kDone);
}

// --- the command in force ------------------------------------------------------------------------

void Driver::BeginCommand() {
  const RobotCommand& command = gate_.command();
  targets_.clear();
  pan_rad_ = 0.0;
  switch (command.kind) {
    case CommandKind::kStop:
      return Finish(CommandOutcome::kDone);
    case CommandKind::kMove:
      break;
    case CommandKind::kTransmitView:
      return BeginView();
    case CommandKind::kDrive:
      phase_ = Phase::kDrive;
      phase_began_ = {};
      return;
  }
  if (command.path.empty() || command.tolerance_m < kLeastToleranceM) {
    return Finish(CommandOutcome::kRefused,
                  fmt::format("a path of {} places, tolerance {} m; at least one and {} m",
                              command.path.size(), command.tolerance_m, kLeastToleranceM));
  }
  state_.command_cell = keeper_->grid().PositionToCell(command.path.back());
  for (const Position place : command.path) {
    if (!keeper_->grid().Contains(keeper_->grid().PositionToCell(place))) {
      state_.command_cell = state_.cell;
      return Finish(CommandOutcome::kRefused,
                    fmt::format("({:.1f}, {:.1f}) m lies off the map", place.x_m, place.y_m));
    }
    targets_.push_back({place, command.tolerance_m, std::nullopt, false});
  }
  targets_.back().last = true;
  targets_.back().heading_rad = command.arrival_heading_rad;
  phase_ = Phase::kDrive;
  BeginLeg();
}

void Driver::BeginView() {
  const double turn_rad = WrapAngle(gate_.command().heading_rad - place_->heading_rad);
  pan_rad_ = pan_ ? std::clamp(turn_rad, options_.pan_least_rad, options_.pan_most_rad) : 0.0;
  if (pan_) pan_(pan_rad_);
  targets_.push_back({place_->position, std::max(kLookAheadM, options_.map.radius_m),
                      WrapAngle(gate_.command().heading_rad - pan_rad_), true});
  state_.command_cell = state_.cell;
  phase_ = Phase::kTurn;
  BeginLeg();
}

void Driver::BeginLeg() {
  least_left_ = 1e9;
  progress_at_ = wall_;
  if (!Problem().empty() || wall_ < not_before_) return Hold();  // Step() begins it
  held_at_.reset();
  if (phase_ == Phase::kDrive && !IsWayOpen()) return;
  mover_->Begin(targets_.front(), *place_);
}

void Driver::Hold() {
  if (held_at_) return;
  held_at_ = place_->position;
  mover_->Cancel(*place_);
}

bool Driver::IsWayOpen() {
  const Position to = targets_.front().place;
  if (const auto obstacle = keeper_->FirstObstacle(place_->position, to, wall_)) {
    state_.command_cell = *obstacle;
    if (keeper_->grid().Contains(*obstacle)) {
      keeper_->Block(*obstacle, wall_ + Seconds(options_.blocked_for_s));
      map_stale_ = true;
    }
    Finish(CommandOutcome::kBlocked, fmt::format("an obstacle at {}", *obstacle));
    return false;
  }
  if (gate_.IsClear(place_->position, to, 2.0 * options_.map.radius_m + options_.clearance_m)) {
    waits_since_.reset();
    return true;
  }
  if (!waits_since_) {
    waits_since_ = wall_;
    mover_->Cancel(*place_);
  }
  state_.command_cell = state_.cell;  // meanwhile it claims no other place
  if (wall_ - *waits_since_ < Seconds(options_.wait_s)) return false;
  state_.command_cell = keeper_->grid().PositionToCell(to);
  Finish(CommandOutcome::kOccupied, std::string(kOccupiedWay));
  return false;
}

bool Driver::IsStuck() {
  const Target& target = targets_.front();
  const double turn_rad =
      target.heading_rad ? std::abs(WrapAngle(*target.heading_rad - place_->heading_rad)) : 0.0;
  // A robot that turns before it drives makes progress, too.
  const double towards_rad =
      std::atan2(target.place.y_m - place_->position.y_m, target.place.x_m - place_->position.x_m);
  const double way_m = Distance(place_->position, target.place);
  const double aside_rad =
      way_m > target.tolerance_m ? std::abs(WrapAngle(towards_rad - place_->heading_rad)) : 0.0;
  const double left = way_m + turn_rad + aside_rad;
  if (left < least_left_ - kProgress) {
    least_left_ = left;
    progress_at_ = wall_;
  }
  return wall_ - progress_at_ > Seconds(options_.stuck_s);
}

void Driver::DriveLeg() {
  const bool waited = waits_since_.has_value();
  if (phase_ == Phase::kDrive && !IsWayOpen()) return;
  if (waited) {
    state_.command_cell = keeper_->grid().PositionToCell(gate_.command().path.back());
    return BeginLeg();
  }
  const Mover::Progress progress = mover_->Step(*place_, wall_);
  if (progress.state == Mover::State::kFailed) {
    not_before_ = wall_ + Seconds(options_.retry_s);
    return Finish(CommandOutcome::kRefused, progress.reason);
  }
  if (progress.state == Mover::State::kArrived) {
    if (phase_ == Phase::kTurn) {
      phase_ = Phase::kPicture;
      phase_began_ = wall_;
      picture_since_ =
          wall_ + Seconds(pan_ ? std::max(options_.pan_settle_s, options_.picture_settle_s)
                               : options_.picture_settle_s);
      return;
    }
    NoteCell();
    ++state_.cell_moves;
    targets_.pop_front();
    return targets_.empty() ? Finish(CommandOutcome::kDone) : BeginLeg();
  }
  if (!IsStuck()) return;
  const Cell next = keeper_->grid().PositionToCell(targets_.front().place);
  if (phase_ == Phase::kDrive && next != keeper_->grid().PositionToCell(place_->position)) {
    keeper_->Block(next, wall_ + Seconds(options_.blocked_for_s));
    map_stale_ = true;
  }
  state_.command_cell = next;
  Finish(CommandOutcome::kBlocked,
         fmt::format("no progress for {} s, {:.2f} m from the place", options_.stuck_s,
                     Distance(place_->position, targets_.front().place)));
}

void Driver::StepDrive() {
  const DriveAction action = gate_.command().drive;
  if (phase_began_ == Clock::TimePoint{}) {
    const double sign = action == DriveAction::kForward    ? 1.0
                        : action == DriveAction::kBackward ? -1.0
                                                           : 0.0;
    const double ahead_m = sign * (options_.map.radius_m + kLookAheadM);
    targets_ = {{*place_ * Position{ahead_m, 0.0}, kLeastToleranceM, std::nullopt, true}};
    if (sign != 0.0 && !IsWayOpen()) return;
    if (!mover_->Drive(action)) {
      return Finish(CommandOutcome::kRefused, "this way to move takes no drive steps");
    }
    phase_began_ = wall_;
    return;
  }
  if (wall_ - phase_began_ < Seconds(kDriveStepS)) return;
  ++state_.low_level_steps;
  Finish(CommandOutcome::kDone);
}

void Driver::AwaitPicture() {
  if (wall_ - phase_began_ < Seconds(options_.picture_timeout_s)) return;
  not_before_ = wall_ + Seconds(options_.retry_s);
  Finish(CommandOutcome::kRefused,
         fmt::format("camera: no picture for {} s after the turn", options_.picture_timeout_s));
}

void Driver::Finish(CommandOutcome outcome, std::string detail) {
  if (place_ && outcome != CommandOutcome::kDone) mover_->Cancel(*place_);
  if (place_ && gate_.command().kind == CommandKind::kDrive) mover_->Cancel(*place_);
  gate_.End(outcome, std::move(detail));
  phase_ = Phase::kIdle;
  targets_.clear();
  picture_since_.reset();
  held_at_.reset();
  waits_since_.reset();
  if (place_) NoteCell();
}

void Driver::Step(SimTime now, Clock::TimePoint wall) {
  now_ = std::max(now_, now);
  wall_ = wall;
  if (!keeper_ || !place_) return;
  RefreshMap();
  if (!gate_.active()) {
    if (location_problem_.empty()) NoteCell();
    return mover_->Rest();
  }
  const std::string problem = Problem();
  if (gate_.command().expires_at <= now_) {
    return Finish(
        CommandOutcome::kExpired,
        fmt::format("not done by {:.3f} s {}", gate_.command().expires_at.ToSeconds(), problem));
  }
  if (!problem.empty()) {
    Hold();
    return mover_->Rest();
  }
  if (wall_ < not_before_) return;
  if (held_at_) {
    if (const double way_m = Distance(*held_at_, place_->position);
        way_m > keeper_->grid().cell_size_m) {
      return Finish(CommandOutcome::kRefused,
                    fmt::format("its place changed by {:.1f} m while it stood", way_m));
    }
    if (!targets_.empty()) BeginLeg();
    held_at_.reset();
    if (!gate_.active()) return;
  }
  if (phase_ == Phase::kPicture) return AwaitPicture();
  gate_.command().kind == CommandKind::kDrive ? StepDrive() : DriveLeg();
}

void Driver::NoteCell() {
  const Cell cell = keeper_->grid().PositionToCell(place_->position);
  if (cell == state_.cell) return;
  state_.cell = cell;
  Extend(state_.path, cell);
}

// --- what goes out -------------------------------------------------------------------------------

void Driver::RefreshMap() {
  if (!map_received_) return;
  // Blocked ways open again by themselves.
  const bool old = map_ && now_.nanoseconds - map_->stamp.nanoseconds >
                               std::chrono::nanoseconds(kMapRefresh).count();
  if (!map_stale_ && !old && map_) return;
  map_stale_ = false;
  OccupancyGrid known = keeper_->Known(wall_);
  if (map_ && known == map_->cells) return;
  // Each map has a stamp of its own.
  if (map_ && now_ <= map_->stamp) {
    map_stale_ = true;
    return;
  }
  const GridGeometry& grid = keeper_->grid();
  map_ = MapUpdate{now_, grid.cell_size_m, std::move(known), grid.middle};
  map_changed_ = true;
}

std::optional<MapUpdate> Driver::TakeMap() {
  if (!std::exchange(map_changed_, false)) return std::nullopt;
  return map_;
}

std::optional<Snapshot> Driver::TakeSnapshot() { return std::exchange(snapshot_, std::nullopt); }

std::optional<RobotState> Driver::state() const {
  if (!map_ || !place_) return std::nullopt;
  RobotState state = state_;
  state.stamp = now_;
  state.grid = keeper_->grid();
  state.map_stamp = map_->stamp;
  gate_.Report(state);
  if (!gate_.active()) return state;
  state.command_detail = Problem();
  if (state.command_detail.empty() && waits_since_) state.command_detail = kOccupiedWay;
  return state;
}

std::string Driver::CameraProblem() const { return lens_ ? "" : "camera: no camera_info yet"; }

std::string Driver::Problem() const {
  if (!keeper_) return fmt::format("waits for /{}/initial_map", options_.world);
  if (!location_problem_.empty()) return location_problem_;
  if (!map_received_) return "map: none yet";
  if (options_.map_timeout_s > 0.0 && wall_ - *map_received_ > Seconds(options_.map_timeout_s)) {
    return fmt::format("map: silent for over {} s", options_.map_timeout_s);
  }
  if (std::string problem = mover_->Problem(); !problem.empty()) return problem;
  const bool looks = gate_.active() && gate_.command().kind == CommandKind::kTransmitView;
  return looks ? CameraProblem() : "";
}

SimTime FollowTimeOfDay(SimTime now, SimTime time_of_day, std::chrono::nanoseconds elapsed) {
  constexpr std::int64_t kLongestGap = std::chrono::nanoseconds(std::chrono::minutes(1)).count();
  const std::int64_t gap = time_of_day.nanoseconds - now.nanoseconds;
  if (gap > kLongestGap) return time_of_day;
  return {now.nanoseconds + std::clamp(gap, elapsed.count() / 2, 2 * elapsed.count())};
}

}  // namespace conav::robot
