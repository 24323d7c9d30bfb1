#include "sim/sim_service.h"

#include <fmt/core.h>

#include "common/msg/convert.h"
#include "common/msg/robot.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "ros2_interfaces.h"
#include "sim/physics/robot_body.h"

namespace conav::sim {
namespace {

constexpr std::int32_t kSphere = 2;  // visualization_msgs/Marker SPHERE
constexpr std::int32_t kAdd = 0;
constexpr std::int32_t kDelete = 2;

float Channel(std::uint8_t value) { return static_cast<float>(value) / 255.0F; }

/// The goals as RViz draws them: one sphere per goal in its colour, frame "map".
/// The name space is the robot that a goal is for, or "goals" where robots share them.
visualization_msgs::msg::MarkerArray GoalMarkers(const Episode& episode, bool shared) {
  const PhysicsWorld& world = episode.physics().world();
  const double diameter = 2.0 * GoalRadius(world);
  visualization_msgs::msg::MarkerArray array;
  for (std::size_t i = 0; i < world.goals.size(); ++i) {
    const GoalSpec& goal = world.goals[i];
    const Rgb rgb = kGoalColors[goal.color_index % kGoalColorCount];
    const Position position = episode.physics().geometry().CellToPosition(goal.cell);
    visualization_msgs::msg::Marker marker;
    marker.header().frame_id("map");
    marker.header().stamp(ToMessage(episode.now()));
    marker.ns(shared ? "goals" : world.robots[static_cast<std::size_t>(goal.color_index)].name);
    marker.id(static_cast<std::int32_t>(i));
    marker.type(kSphere);
    marker.action(episode.physics().goal_visible(static_cast<int>(i)) ? kAdd : kDelete);
    marker.pose().position().x(position.x_m);
    marker.pose().position().y(position.y_m);
    marker.pose().orientation().w(1.0);
    marker.scale().x(diameter);
    marker.scale().y(diameter);
    marker.scale().z(diameter);
    marker.color().r(Channel(rgb.red));
    marker.color().g(Channel(rgb.green));
    marker.color().b(Channel(rgb.blue));
    marker.color().a(1.0F);
    array.markers().push_back(std::move(marker));
  }
  return array;
}

constexpr std::chrono::milliseconds kIdleWait{100};
constexpr std::chrono::milliseconds kRestFramePeriod{500};

std::vector<Cell> CellsFrom(const std::vector<std::vector<int>>& pairs, const char* key) {
  std::vector<Cell> cells;
  for (const std::vector<int>& pair : pairs) {
    if (pair.size() != 2) {
      throw StartupError(fmt::format("sim.{}: [{}] is not [row, column]", key, Join(pair, ", ")));
    }
    cells.push_back({pair[0], pair[1]});
  }
  return cells;
}

WorldOptions OptionsFrom(const SimConfig& config) {
  return {.seed = config.seed,
          .preset = config.preset,
          .map_yaml = config.map.yaml,
          .height_map = {config.map.height_map, config.map.water_level, config.map.resolution_m},
          .operator_map_yaml = config.map.operator_yaml,
          .cell_size_m = config.map.cell_size_m,
          .occupied_share = config.map.occupied_share,
          .terrain_rows = config.terrain.rows,
          .terrain_columns = config.terrain.columns,
          .terrain_cell_size_m = config.terrain.cell_size_m,
          .open = config.map.open || config.map.cell_size_m < kMinCellSizeM,
          .robot_radius_m = config.body.radius_m,
          .robots = static_cast<int>(config.robots.size()),
          .goals_per_robot = config.goals_per_robot,
          .shared_goals = config.shared_goals,
          .starts = CellsFrom(config.starts, "starts"),
          .goals = CellsFrom(config.goals, "goals"),
          .wrong_share = config.corruption.wrong_share,
          .false_wall_share = config.corruption.false_wall_share,
          .wing_error = config.corruption.wing_error,
          .rotation_deg = config.rotation_deg,
          .closing_doors = config.closing_doors};
}

/// Names become parts of topics.
void CheckName(const char* key, const std::string& name) {
  if (IsEntityName(name)) return;
  throw StartupError(
      fmt::format("sim.{}: '{}' is not a name: 1 to 64 of A-Z a-z 0-9 _", key, name));
}

void CheckNames(const SimConfig& config) {
  CheckName("world", config.world);
  if (config.robots.empty()) throw StartupError("sim.robots: a world needs at least one robot");
  for (const std::string& robot : config.robots) CheckName("robots", robot);
}

template <class T>
T OrStartupError(Result<T> result) {
  if (!result) throw StartupError(result.error().text);
  return *std::move(result);
}

PhysicsWorld PhysicsFrom(const WorldSpec& spec, const SimConfig& config) {
  PhysicsWorld world = PhysicsOf(spec, config.robots);
  world.robot_radius_m = config.body.radius_m;
  world.top_speed_mps = config.body.top_speed_mps;
  world.texture_seed = config.seed;
  return world;
}

DriveLimits LimitsFrom(const DriveConfig& config) {
  constexpr double kRadiansPerDegree = 0.017453292519943295;
  return {config.forward_mps, config.backward_mps, config.turn_deg_per_s * kRadiansPerDegree};
}

/// What a checkpoint belongs to: the world, in whatever domain.
std::string WorldOf(SimConfig config) {
  config.bus = {};
  return DumpConfig("sim", std::move(config));
}

}  // namespace

SimService::SimService(bus::Participant& participant, const SimConfig& config, const Clock& clock)
    : participant_(participant),
      config_(config),
      clock_(clock),
      checkpoint_(config.checkpoint, WorldOf(config), clock),
      truth_(participant, bus::kTruth, config.world),
      initial_map_(participant, bus::kInitialMap, config.world),
      goals_(participant, bus::kGoals, config.world),
      services_(participant, config.world),
      diagnostics_(participant, clock),
      asked_speed_(config.speed) {
  CheckNames(config);
  Start(true);
}

void SimService::Start(bool resumes) {
  motion_.reset();
  camera_.reset();
  BuildWorld();
  const bool resumed = resumes && checkpoint_.Restore(*episode_, config_.speed);
  checkpoint_.Save(*episode_);
  motion_.emplace(participant_, config_, *physics_);
  // Robots keep their topics: new subscribers would get commands of before again.
  for (const auto& robot : robots_) robot->Restart();
  for (std::size_t i = robots_.size(); i < config_.robots.size(); ++i) {
    const std::string& robot = config_.robots[i];
    robots_.push_back(std::make_unique<RobotTopics>(participant_, robot, config_.camera.width,
                                                    config_.camera.height));
    frame_sent_at_.push_back(clock_.Now());
  }
  next_step_ = clock_.Now();
  doors_published_ = -1;
  goals_published_ = -1;
  if (resumed) PublishPictures(checkpoint_.Pictures(*episode_));
  PublishWorld();
}

SimService::~SimService() = default;

void SimService::BuildWorld() {
  spec_ = OrStartupError(MakeWorldSpec(OptionsFrom(config_)));
  physics_ = OrStartupError(RobotWorld::Create(PhysicsFrom(spec_, config_)));
  double range_cells = config_.observation_distance_cells;
  if (range_cells == 0.0) range_cells = spec_.open ? 50.0 : 2.0;
  episode_ = std::make_unique<Episode>(
      *physics_, EpisodeOptions{config_.world, spec_.goals, spec_.shared_goals, range_cells,
                                LimitsFrom(config_.drive), spec_.open, config_.body.radius_m,
                                config_.keeps_goals, spec_.doors});
  if (config_.camera.mode == "none") return;
  auto camera = Camera::Open(*physics_, {config_.camera.width, config_.camera.height});
  if (!camera) {
    throw StartupError(camera.error().text + ": camera.mode: none (--camera none)");
  }
  camera_ = *std::move(camera);
  LOG_INFO("camera", "renderer", camera_->renderer_name(), "width", config_.camera.width, "height",
           config_.camera.height);
}

void SimService::PublishWorld() {
  motion_->PublishNow(episode_->now());
  motion_->PublishFixed(episode_->now());
  PublishTruth();
  bus::Send(initial_map_,
            ToMessage(MapUpdate{episode_->now(), spec_.cell_size_m, spec_.human_map}));
  PublishGoals();
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    RobotTopics& topics = TopicsOf(robot);
    topics.PublishDescription(WriteUrdf(physics_->world(), robot));
    topics.PublishCameraInfo(episode_->now());
  }
  PublishRobots();
}

void SimService::PublishRobots() {
  checkpoint_.Save(*episode_);
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    TopicsOf(robot).PublishChanges(*episode_, robot, clock_.Now());
  }
}

void SimService::PublishTruth() {
  if (doors_published_ == episode_->doors_closed()) return;
  doors_published_ = episode_->doors_closed();
  bus::Send(truth_,
            ToMessage(MapUpdate{episode_->now(), spec_.cell_size_m, physics_->world().truth}));
}

void SimService::PublishGoals() {
  const auto& goals = physics_->world().goals;
  int visible = 0;
  for (int goal = 0; goal < static_cast<int>(goals.size()); ++goal) {
    visible += physics_->goal_visible(goal) ? 1 : 0;
  }
  if (visible == goals_published_) return;
  goals_published_ = visible;
  bus::Send(goals_, GoalMarkers(*episode_, spec_.shared_goals));
}

void SimService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    if (!Turn()) {
      auto next = clock_.Now() + kIdleWait;
      if (config_.speed > 0.0 && !services_.paused()) next = std::min(next, next_step_);
      if (const auto due = motion_->next_due()) next = std::min(next, *due);
      participant_.Wait(std::max<std::chrono::nanoseconds>(next - clock_.Now(), {}));
    }
    diagnostics_.Tick([this] { return Report(); });
  }
  checkpoint_.Remove(*episode_);
}

bool SimService::Turn() {
  services_.Turn();
  if (services_.TakeReset()) {
    LOG_INFO("the world starts again", "world", config_.world);
    Start(false);
  }
  if (asked_speed_ != config_.speed) {
    config_.speed = asked_speed_;
    motion_->SetSpeed(config_.speed);
    next_step_ = clock_.Now();
  }
  TakeCommands();
  motion_->PublishDue(clock_.Now());
  StreamToViewers();
  if (!StepDue()) return false;
  Step();
  return true;
}

void SimService::TakeCommands() {
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    RobotTopics& topics = TopicsOf(robot);
    for (const StopOrder& order : topics.TakeStopOrders()) {
      if (order.robot == topics.robot()) episode_->Accept(order);
    }
    for (const RobotCommand& command : topics.TakeCommands()) {
      if (const auto accepted = Accept(command, topics.robot()); !accepted) {
        LOG_WARNING("command refused", "reason", accepted.error().text, "count",
                    ++refused_commands_);
      }
    }
  }
  PublishRobots();
}

Result<void> SimService::Accept(const RobotCommand& command, const std::string& robot) {
  if (command.robot == robot) return episode_->Accept(command);
  return Fail(ErrorCode::kRefused,
              fmt::format("robot = '{}' on the topic of {}", command.robot, robot));
}

bool SimService::StepDue() {
  const auto now = clock_.Now();
  if (services_.paused()) {
    next_step_ = now;
    return services_.TakeStep();
  }
  if (config_.speed <= 0.0) return episode_->active();
  if (now < next_step_) return false;
  next_step_ += StepPeriod();
  // Behind by more than a second (the machine was busy): continue from here instead of catching up.
  if (now - next_step_ > std::chrono::seconds(1)) next_step_ = now;
  return true;
}

std::chrono::nanoseconds SimService::StepPeriod() const {
  if (config_.speed <= 0.0) return {};
  const std::chrono::duration<double> period(kControlStepS / config_.speed);
  return std::chrono::duration_cast<std::chrono::nanoseconds>(period);
}

void SimService::Step() {
  std::vector<std::uint64_t> steps_before;
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    steps_before.push_back(episode_->state(robot).low_level_steps);
  }
  if (motion_->Begin(episode_->now(), next_step_ - StepPeriod())) {
    episode_->Step([this](int substep) { motion_->Sample(substep); });
  } else {
    episode_->Step();
  }
  const std::vector<Snapshot> snapshots = TakeSnapshots(steps_before);
  checkpoint_.Save(*episode_);
  motion_->End(clock_.Now());
  PublishTruth();
  PublishGoals();
  PublishPictures(snapshots);
  PublishRobots();
}

void SimService::PublishPictures(const std::vector<Snapshot>& pictures) {
  for (const Snapshot& picture : pictures) {
    for (const auto& robot : robots_) {
      if (robot->robot() == picture.robot) robot->Publish(picture);
    }
  }
}

std::vector<Snapshot> SimService::TakeSnapshots(const std::vector<std::uint64_t>& steps_before) {
  std::vector<Snapshot> snapshots;
  for (const int robot : episode_->snapshots_due()) {
    std::vector<std::uint8_t> jpeg = RenderJpeg(robot);
    if (!jpeg.empty()) PublishFrame(robot, jpeg);
    Snapshot snapshot = episode_->CompleteView(robot, jpeg.size());
    snapshot.jpeg = std::move(jpeg);
    spec_.open ? FillFrom(robot, snapshot) : Fill(snapshot);
    checkpoint_.Keep(snapshot);
    snapshots.push_back(std::move(snapshot));
  }
  if (!config_.camera.stream) return snapshots;
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    const std::uint64_t before = steps_before[static_cast<std::size_t>(robot)];
    if (episode_->state(robot).low_level_steps != before) {
      snapshots.push_back(StreamedSnapshot(robot));
    }
  }
  return snapshots;
}

Snapshot SimService::StreamedSnapshot(int robot) {
  const std::vector<std::uint8_t> jpeg = RenderJpeg(robot);
  episode_->CountFrame(robot, jpeg.size());
  if (!jpeg.empty()) PublishFrame(robot, jpeg);
  Snapshot snapshot = episode_->TakeStreamedSnapshot(robot);
  FillFrom(robot, snapshot);
  return snapshot;
}

void SimService::PublishFrame(int robot, const std::vector<std::uint8_t>& jpeg) {
  TopicsOf(robot).PublishFrame(episode_->now(), jpeg);
  frame_sent_at_[static_cast<std::size_t>(robot)] = clock_.Now();
}

void SimService::StreamToViewers() {
  if (!camera_) return;
  const bool streams = config_.camera.stream;
  const std::chrono::duration<double> live_period(1.0 / config_.camera.live_hz);
  for (int robot = 0; robot < episode_->robot_count(); ++robot) {
    Clock::TimePoint& sent_at = frame_sent_at_[static_cast<std::size_t>(robot)];
    const std::chrono::duration<double> since = clock_.Now() - sent_at;
    if (since < (streams ? kRestFramePeriod : live_period) || !TopicsOf(robot).has_viewers()) {
      continue;
    }
    sent_at = clock_.Now();
    const std::vector<std::uint8_t> jpeg = RenderJpeg(robot);
    if (jpeg.empty()) continue;
    PublishFrame(robot, jpeg);
    if (!streams) episode_->CountViewedFrame(robot, jpeg.size());
  }
}

std::vector<std::uint8_t> SimService::RenderJpeg(int robot) {
  if (!camera_) return {};
  auto jpeg = EncodeJpeg(camera_->Render(robot), config_.camera.jpeg_quality);
  if (!jpeg) {
    LOG_ERROR("picture lost", "reason", jpeg.error().text);
    return {};
  }
  return *std::move(jpeg);
}

void SimService::Fill(Snapshot& snapshot) const {
  Fill(snapshot, ViewAt(snapshot.cell, snapshot.heading_rad, spec_.cell_size_m,
                        config_.camera.width, config_.camera.height));
}

void SimService::FillFrom(int robot, Snapshot& snapshot) const {
  CameraView view = ViewAt(snapshot.cell, snapshot.heading_rad, spec_.cell_size_m,
                           config_.camera.width, config_.camera.height);
  const Position at = physics_->pose(robot).position;
  const Position centre = physics_->geometry().CellToPosition(snapshot.cell);
  view.east_offset_cells = (at.x_m - centre.x_m) / spec_.cell_size_m;
  view.south_offset_cells = (centre.y_m - at.y_m) / spec_.cell_size_m;
  Fill(snapshot, view);
}

void SimService::Fill(Snapshot& snapshot, const CameraView& view) const {
  snapshot.horizontal_fov_rad = view.horizontal_fov_rad;
  snapshot.width = static_cast<std::uint32_t>(config_.camera.width);
  snapshot.height = static_cast<std::uint32_t>(config_.camera.height);
  snapshot.visible = CastView(physics_->world().truth, view);
}

Health SimService::Report() const {
  Health health;
  health.message = fmt::format("{} robots in {}", robots_.size(), config_.world);
  health.values.emplace_back("simulation_time_s",
                             fmt::format("{:.2f}", episode_->now().ToSeconds()));
  health.values.emplace_back("refused_commands", fmt::format("{}", refused_commands_));
  return health;
}

}  // namespace conav::sim
