#include "robot/driver/driver_service.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "robot/driver/mover_topics.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;

constexpr auto kStep = 50ms;
constexpr auto kStatePeriod = 200ms;
constexpr auto kKeepPeriod = 1s;  // after a failure
constexpr double kRadiansPerDegree = 0.017453292519943295;

Alignment AlignmentFrom(const AlignmentConfig& config) {
  if (config.pairs.empty()) {
    return {{{config.x_m, config.y_m}, WrapAngle(config.yaw_deg * kRadiansPerDegree)}, 0.0};
  }
  std::vector<PointPair> pairs;
  for (const std::vector<double>& pair : config.pairs) {
    if (pair.size() != 4) {
      throw StartupError(
          fmt::format("driver.alignment.pairs[{}] has {} numbers, not 4: x, y on the "
                      "robot's map, x, y on the plan",
                      pairs.size(), pair.size()));
    }
    pairs.push_back({{pair[0], pair[1]}, {pair[2], pair[3]}});
  }
  const auto alignment = AlignByPairs(pairs, config.most_residual_m);
  if (!alignment) throw StartupError("driver.alignment.pairs: " + alignment.error().text);
  return *alignment;
}

void CheckNames(const DriverConfig& config) {
  std::vector<std::string> names = config.others;
  names.push_back(config.world);
  names.push_back(config.robot);
  for (const std::string& name : names) {
    if (IsEntityName(name)) continue;
    throw StartupError(fmt::format("driver: '{}' is not a name: 1 to 64 of A-Z a-z 0-9 _", name));
  }
  if (std::ranges::find(config.others, config.robot) != config.others.end()) {
    throw StartupError(fmt::format("driver.others: {} is the robot itself", config.robot));
  }
  if (config.map.occupied_from <= config.map.free_up_to) {
    throw StartupError("driver.map: occupied_from is not above free_up_to");
  }
}

DriverOptions OptionsFrom(const DriverConfig& config) {
  CheckNames(config);
  const RobotCameraConfig& camera = config.camera;
  DriverOptions options;
  options.world = config.world;
  options.robot = config.robot;
  options.map = {config.move.radius_m, config.map.free_up_to, config.map.occupied_from};
  options.view = {camera.range_m, camera.forward_m, camera.height_m,
                  camera.pitch_deg * kRadiansPerDegree};
  options.clearance_m = config.move.clearance_m;
  options.wait_s = config.move.wait_s;
  options.stuck_s = config.move.stuck_s;
  options.blocked_for_s = config.move.blocked_for_s;
  options.map_timeout_s = config.map.timeout_s;
  options.picture_timeout_s = camera.timeout_s;
  options.picture_settle_s = camera.latency_s;
  options.pan_least_rad = camera.pan_least_deg * kRadiansPerDegree;
  options.pan_most_rad = camera.pan_most_deg * kRadiansPerDegree;
  options.pan_settle_s = camera.pan_settle_s;
  return options;
}

Localisation::Options LocalisationFrom(const DriverConfig& config) {
  const LocalisationConfig& from = config.localisation;
  return {from.timeout_s,
          from.correction_timeout_s,
          from.jump_m,
          from.jump_deg * kRadiansPerDegree,
          from.settle_s,
          2.0 * config.move.speed_mps,
          2.0 * config.move.turn_rps};
}

/// What others see at once.
bool IsNews(const RobotState& state, const std::optional<RobotState>& sent) {
  return !sent || state.command_sequence_number != sent->command_sequence_number ||
         state.lease_epoch != sent->lease_epoch || state.command_outcome != sent->command_outcome ||
         state.command_detail != sent->command_detail || state.stopped != sent->stopped ||
         state.stop_revision != sent->stop_revision || state.map_stamp != sent->map_stamp ||
         state.snapshots != sent->snapshots || state.path != sent->path;
}

/// What Keep() wrote of this robot; what it begins with where there is no file.
RobotState ReadLatched(const std::string& file, const std::string& robot) {
  RobotState state;
  if (file.empty()) return state;
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return state;
  if (!text) throw StartupError(text.error().text);
  try {
    const auto kept = nlohmann::json::parse(*text);
    const std::string of = kept.at("robot");
    if (of != robot) throw StartupError(fmt::format("{} is of robot {}, not {}", file, of, robot));
    state.lease_epoch = kept.at("lease_epoch");
    state.stop_revision = kept.at("stop_revision");
    state.stopped = kept.at("stopped");
  } catch (const nlohmann::json::exception& failed) {
    throw StartupError(fmt::format("{}: {}; if it is removed the robot begins without a stop", file,
                                   failed.what()));
  }
  return state;
}

}  // namespace

DriverService::DriverService(bus::Participant& participant, const DriverConfig& config,
                             const Clock& clock)
    : participant_(participant),
      config_(config),
      clock_(clock),
      alignment_(AlignmentFrom(config.alignment)),
      robot_(participant, config, alignment_.plan_from_robot),
      localisation_(LocalisationFrom(config)),
      driver_(OptionsFrom(config), MakeMover(participant, config, alignment_.plan_from_robot),
              MakePan(participant, config)),
      states_(participant, config.robot),
      maps_(participant, bus::kRobotMap, bus::kRobotMapChanges, config.robot),
      snapshots_(participant, bus::kSnapshot, config.robot),
      camera_info_(participant, bus::kCameraInfo, config.robot),
      commands_(participant, bus::kRobotCommand, config.robot),
      stops_(participant, bus::kStopOrder, config.robot),
      initial_map_(participant, bus::kInitialMap, config.world),
      diagnostics_(participant, clock) {
  if (config.use_sim_time) clock_topic_.emplace(participant, bus::kClock);
  for (const std::string& other : config.others) {
    others_[other] = std::make_unique<bus::Subscriber<conav_msgs::msg::RobotState>>(
        participant, bus::kRobotState, other);
  }
  if (!config.state_file.empty()) {
    if (const auto may = CheckWritable(config.state_file); !may)
      throw StartupError(may.error().text);
    driver_.Restore(ReadLatched(config.state_file, config.robot));
    LOG_INFO("state file", "file", config.state_file, "stopped", driver_.latched().stopped);
  }
  const Pose& place = alignment_.plan_from_robot;
  LOG_INFO("map aligned", "x_m", place.position.x_m, "y_m", place.position.y_m, "yaw_deg",
           place.heading_rad / kRadiansPerDegree, "residual_m", alignment_.residual_m);
}

void DriverService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    Turn();
    diagnostics_.Tick([this] { return Report(); });
    const auto left = next_step_ - clock_.Now();
    participant_.Wait(std::clamp<std::chrono::nanoseconds>(left, 0ns, kStep));
  }
  driver_.Stand();
}

void DriverService::Turn() {
  TakeTime();
  TakeInputs();
  const Clock::TimePoint wall = clock_.Now();
  if (wall >= next_step_) {
    next_step_ = std::max(next_step_ + kStep, wall);
    TakeOthers();
    if (has_time_) driver_.Step(now_, wall);
  }
  if (!has_time_) return;
  for (const StopOrder& order : stops_.TakeValid(kToDomain)) driver_.Receive(order);
  for (const RobotCommand& command : commands_.TakeValid(kToDomain)) {
    if (const auto received = driver_.Receive(command, now_); !received) {
      LOG_WARNING("command refused", "reason", received.error().text, "count", ++refused_commands_);
    }
  }
  Keep();
  TakePicture();
  Publish();
  NoteProblem();
}

void DriverService::Keep() {
  const RobotState latched = driver_.latched();
  std::string text =
      fmt::format(R"({{"robot": "{}", "lease_epoch": {}, "stop_revision": {}, "stopped": {}}})",
                  config_.robot, latched.lease_epoch, latched.stop_revision, latched.stopped);
  if (config_.state_file.empty() || text == kept_ || clock_.Now() < keep_due_at_) return;
  const auto written = WriteDurableFile(config_.state_file, text + "\n");
  not_kept_ = written ? "" : written.error().text;
  keep_due_at_ = clock_.Now() + (written ? 0s : kKeepPeriod);
  if (written) kept_ = std::move(text);
}

void DriverService::TakeTime() {
  if (!clock_topic_) {
    const std::chrono::nanoseconds since = std::chrono::system_clock::now().time_since_epoch();
    const auto elapsed = clock_.Now() - std::exchange(time_taken_at_, clock_.Now());
    now_ = FollowTimeOfDay(now_, SimTime{since.count()}, elapsed);
    has_time_ = true;
    return;
  }
  for (const SimTime time : clock_topic_->TakeValid(
           [](const rosgraph_msgs::msg::Clock& message) { return ToDomain(message.clock()); })) {
    now_ = std::max(now_, time);
    has_time_ = true;
  }
}

void DriverService::TakeInputs() {
  const Clock::TimePoint wall = clock_.Now();
  for (const MapUpdate& plan : initial_map_.TakeValid(kToDomain)) driver_.SetGrid(plan.geometry());
  robot_.Receive(wall);
  localisation_.Step(robot_.place(), wall);
  std::optional<Pose> place;
  if (localisation_.pose()) place = alignment_.plan_from_robot * *localisation_.pose();
  driver_.Locate(place, localisation_.problem(), robot_.speed_mps(), robot_.turn_rps());
  if (driver_.has_grid()) {
    if (auto map = robot_.TakeMap()) driver_.Receive(*std::move(map), wall);
  }
  sensor_msgs::msg::CameraInfo info;
  const auto lens = robot_.TakeLens(info);
  if (!lens || lens == lens_) return;
  lens_ = lens;
  driver_.Receive(*lens);
  info.header().stamp(ToMessage(now_));
  bus::Send(camera_info_, info);
}

void DriverService::TakeOthers() {
  if (others_.empty()) return;
  std::vector<Position> held;
  for (auto& [name, states] : others_) {
    for (RobotState& state : states->TakeValid(kToDomain)) other_states_[name] = std::move(state);
    const auto found = other_states_.find(name);
    if (found == other_states_.end() || found->second.world != config_.world) continue;
    held.push_back(found->second.position);
    if (found->second.command_outcome == CommandOutcome::kRunning) {
      held.push_back(found->second.grid.CellToPosition(found->second.command_cell));
    }
  }
  driver_.SetHeldByOthers(std::move(held));
}

void DriverService::TakePicture() {
  const auto since = driver_.picture_wanted_since();
  if (!since || clock_.Now() < *since) return;
  auto picture = robot_.PictureSince(*since, config_.camera.jpeg_quality);
  if (!picture) return;
  if (*picture) {
    driver_.Receive(**std::move(picture), robot_.DepthSince(*since), now_);
  } else {
    LOG_WARNING("picture refused", "reason", picture->error().text);
  }
}

void DriverService::Publish() {
  if (const auto map = driver_.TakeMap()) maps_.Send(ToMessage(*map));
  if (const auto snapshot = driver_.TakeSnapshot()) bus::Send(snapshots_, ToMessage(*snapshot));
  const auto state = driver_.state();
  const Clock::TimePoint wall = clock_.Now();
  if (!state || (wall < next_state_ && !IsNews(*state, sent_))) return;
  next_state_ = wall + kStatePeriod;
  sent_ = state;
  states_.Publish(*state, wall);
}

void DriverService::NoteProblem() {
  std::string problem = driver_.Problem();
  if (problem == problem_) return;
  if (problem.empty()) {
    LOG_INFO("ready", "after", problem_);
  } else {
    LOG_WARNING("the robot stands", "reason", problem);
  }
  problem_ = std::move(problem);
}

Health DriverService::Report() const {
  Health health;
  const std::string problem = has_time_ ? driver_.Problem() : "waits for /clock";
  health.level = problem.empty() ? Health::Level::kOk : Health::Level::kWarning;
  health.message = problem.empty() ? fmt::format("{} in {}", config_.robot, config_.world)
                                   : fmt::format("{} stands: {}", config_.robot, problem);
  if (!not_kept_.empty()) {
    health.level = Health::Level::kWarning;
    health.message += "; its stop is not kept over a restart: " + not_kept_;
  }
  const auto add = [&](const char* key, std::string value) {
    health.values.emplace_back(key, std::move(value));
  };
  add("alignment_residual_m", fmt::format("{:.3f}", alignment_.residual_m));
  if (const auto drift = robot_.drift()) {
    add("drift_m", fmt::format("{:.3f}", Distance({}, drift->position)));
    add("drift_deg", fmt::format("{:.1f}", drift->heading_rad / kRadiansPerDegree));
  }
  add("localisation_jumps", fmt::format("{}", localisation_.jumps()));
  if (sent_) {
    add("x_m", fmt::format("{:.2f}", sent_->position.x_m));
    add("y_m", fmt::format("{:.2f}", sent_->position.y_m));
    add("pictures", fmt::format("{}", sent_->snapshots));
  }
  add("refused_commands", fmt::format("{}", refused_commands_));
  return health;
}

}  // namespace conav::robot
