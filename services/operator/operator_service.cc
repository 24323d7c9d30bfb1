#include <algorithm>
#include <chrono>
#include <set>

#include "common/bus/send.h"
#include "common/grid/map_accuracy.h"
#include "common/protocol/convert.h"
#include "common/service/robot_list.h"
#include "operator/console/wall_seconds.h"
#include "operator/operator_links.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookAroundPeriod = 250ms;
constexpr auto kTidyUpPeriod = 10s;
/// Nobody repeats a request so long: those of pages count for seconds, other clients give up earlier.
constexpr double kRequestsKeptS = 86400.0;
constexpr std::int64_t kForgottenAtOnce = 200;
constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

BeliefStoreOptions StoreOptions(const OperatorConfig& config) {
  const auto limit = static_cast<std::int64_t>(config.database_limit_mib * 1024.0 * 1024.0);
  return {{config.database, limit}, {config.max_guidance_s, config.max_path_cells}};
}

}  // namespace

OperatorService::OperatorService(bus::Participant& participant, const OperatorConfig& config,
                                 const Clock& clock)
    : participant_(participant),
      clock_(clock),
      store_(StoreOptions(config)),
      control_(participant, config, store_, clock),
      drive_gate_(WorldOfRobot("operator", config.robots), {}),
      requests_(participant, bus::kOperatorRequest),
      replies_(participant, bus::kOperatorReply),
      clock_topic_(participant, bus::kClock),
      attention_(participant, config.attention, clock),
      services_(participant, clock),
      alerts_(store_),
      diagnostics_(participant, clock) {
  std::set<std::string> worlds;
  for (const auto& [robot, world] : WorldOfRobot("operator", config.robots)) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot, world));
    worlds.insert(world);
  }
  for (const std::string& world : worlds) {
    worlds_.push_back(std::make_unique<WorldLink>(participant, world));
  }
  if (!config.recording.file.empty()) {
    segments_.emplace(participant, config.recording, WorldOfRobot("operator", config.robots),
                      clock);
  }
  if (config.task.on()) task_.emplace(participant, config, store_, clock);
  if (config.console.on()) console_.emplace(participant, config, clock);
}

OperatorService::~OperatorService() = default;

void OperatorService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    participant_.Wait(100ms);
    Step();
  }
}

void OperatorService::Step() {
  for (const auto& world : worlds_) TakeInitialMap(*world);
  TakeClock();
  for (const auto& robot : robots_) TakeStates(*robot);
  for (const auto& robot : robots_) TakeAttention(*robot);
  if (segments_) segments_->Step();
  if (task_) task_->Step();
  AnswerBus();
  if (console_) AnswerConsole();
  attention_.Step(OperatorTime());
  control_.Step();
  services_.Step();
  if (clock_.Now() >= look_around_at_) LookAround();
  if (task_) FollowTask();
  if (console_) ShowOnConsole();
  diagnostics_.Tick([this] { return Report(); });
}

void OperatorService::LookAround() {
  look_around_at_ = clock_.Now() + kLookAroundPeriod;
  alerts_.Update(RobotConditions(), services_.services(), storage_failure_, WallSeconds());
  if (clock_.Now() >= tidy_up_at_) TidyUp();
  if (!console_) return;
  console_->Hear(services_.services());
  console_->SetReadiness(Report());
}

std::vector<RobotCondition> OperatorService::RobotConditions() const {
  std::vector<RobotCondition> conditions;
  for (const auto& robot : robots_) {
    if (!robot->stamp) continue;
    conditions.push_back({robot->name, robot->state.matched_publishers() == 0,
                          Stands(attention_.items(), robot->name)});
  }
  return conditions;
}

void OperatorService::TidyUp() {
  tidy_up_at_ = clock_.Now() + kTidyUpPeriod;
  const double kept_from_s = WallSeconds() - kRequestsKeptS;
  if (const auto forgotten = store_.ForgetRequests(kept_from_s, kForgottenAtOnce); !forgotten) {
    LOG_WARNING("old requests not removed", "reason", forgotten.error().text);
  }
}

void OperatorService::ShowOnConsole() {
  if (attention_.published().revision != attention_shown_) {
    attention_shown_ = attention_.published().revision;
    console_->Hear(attention_.published());
  }
  if (control_.book().version() != control_shown_) {
    control_shown_ = control_.book().version();
    console_->Hear(control_.book());
  }
  const std::vector<Alert> alerts = alerts_.TakeChanges();
  for (const Alert& alert : alerts) console_->Hear(alert);
  console_->Publish();
}

void OperatorService::Serve(WorldLink& world, double cell_size_m) {
  world.refusal.clear();
  world.cell_size_m = cell_size_m;
  if (!world.served()) {
    world.belief.emplace(participant_, bus::kBelief, world.name);
    world.belief_map.emplace(participant_, bus::kBeliefMap, world.name);
  }
  PublishBelief(world);
  if (segments_) segments_->Begin(*store_.FindBelief(world.name));
  for (const auto& robot : robots_) {
    if (robot->world != world.name) continue;
    const Guidance* guidance = store_.FindGuidance(robot->name);
    if (segments_ && guidance != nullptr) {
      segments_->Skip(robot->name, guidance->answers_snapshot);
    }
    if (guidance != nullptr) attention_.Hear(*guidance, OperatorTime());
    if (!robot->guidance) robot->guidance.emplace(participant_, bus::kGuidance, robot->name);
    PublishGuidance(*robot);
  }
}

void OperatorService::Withhold(WorldLink& world, std::string reason) {
  world.refusal = std::move(reason);
  world.belief.reset();
  world.belief_map.reset();
  for (const auto& robot : robots_) {
    if (robot->world == world.name) robot->guidance.reset();
  }
}

OperatorService::WorldLink* OperatorService::FindWorld(const std::string& name) {
  const auto found = std::ranges::find(worlds_, name, &WorldLink::name);
  return found == worlds_.end() ? nullptr : found->get();
}

void OperatorService::PublishBelief(WorldLink& world) {
  const Belief* belief = store_.FindBelief(world.name);
  if (belief == nullptr || !world.served()) return;
  bus::Send(*world.belief, ToMessage(*belief));
  bus::Send(*world.belief_map, ToOccupancyMessage(*belief, world.cell_size_m));
  if (console_) console_->Hear(*belief, world.initial);
}

void OperatorService::PublishGuidance(RobotLink& robot) {
  const Guidance* guidance = store_.FindGuidance(robot.name);
  if (robot.guidance && guidance != nullptr && guidance->world == robot.world) {
    bus::Send(*robot.guidance, ToMessage(*guidance));
    if (console_) console_->Hear(*guidance);
  }
}

void OperatorService::TakeInitialMap(WorldLink& world) {
  auto maps = world.initial_map.TakeValid(kConvert);
  if (!maps.empty()) world.pending = std::move(maps.back());
  if (!world.pending) return;
  const auto added =
      store_.AddWorld(world.name, ToBelief(world.pending->cells), world.pending->stamp);
  if (!added && added.error().code == ErrorCode::kIo) {
    storage_failure_ = added.error().text;  // the map stays pending; the next step tries again
    return;
  }
  if (added) {
    if (*added) storage_failure_ = "";
    LOG_INFO("world", "world", world.name, "new", *added, "revision",
             store_.FindBelief(world.name)->revision);
    if (console_) console_->HearGeometry(world.name, *world.pending);
    world.initial = ToBelief(world.pending->cells);
    Serve(world, world.pending->cell_size_m);
  } else {
    LOG_ERROR("initial map refused", "world", world.name, "reason", added.error().text);
    Withhold(world, added.error().text);
  }
  world.pending.reset();
}

void OperatorService::TakeStates(RobotLink& robot) {
  for (const auto& stamped : robot.state.TakeValidStamped(kConvert)) {
    const RobotState& state = stamped.value;
    if (state.world != robot.world) {
      LOG_WARNING("state of another world ignored", "robot", robot.name, "world", state.world,
                  "configured", robot.world);
      continue;
    }
    const bool starts = !robot.stamp || state.stamp < *robot.stamp;
    robot.stamp = state.stamp;
    drive_gate_.Hear(state);
    if (segments_) segments_->Hear(state);
    if (task_) task_->Hear(state);
    if (console_) console_->Hear(stamped);
    attention_.Hear(state, OperatorTime());
    if (!starts) continue;
    store_.AddRobot(robot.name, robot.world);
    robot.first_state = state;
  }
  // Before the world is known to be the stored one, nothing stored is changed.
  const WorldLink* world = FindWorld(robot.world);
  if (robot.first_state && world != nullptr && world->served()) {
    Greet(robot, *robot.first_state);
    robot.first_state.reset();
  }
}

void OperatorService::TakeAttention(RobotLink& robot) {
  if (robot.state.matched_publishers() == 0) attention_.LoseLink(robot.name, OperatorTime());
  if (robot.attention.matched_publishers() == 0) attention_.LosePlanner(robot.name, OperatorTime());
  for (const AttentionRequest& request : robot.attention.TakeValid(kConvert)) {
    ++robot.asked;
    attention_.Hear(request, OperatorTime());
  }
}

void OperatorService::TakeClock() {
  for (const auto& message : clock_topic_.Take()) {
    if (const auto time = ToDomain(message.clock())) newest_clock_ = *time;
  }
}

void OperatorService::Greet(RobotLink& robot, const RobotState& state) {
  const Guidance* guidance = store_.FindGuidance(robot.name);
  if (guidance == nullptr || guidance->answers_snapshot <= state.snapshots) return;
  LOG_WARNING("robot counts its pictures anew, its guidance of before is withdrawn", "robot",
              robot.name, "snapshots", state.snapshots, "answered", guidance->answers_snapshot);
  if (const auto withdrawn = store_.WithdrawGuidance(robot.name, state.stamp); !withdrawn) {
    LOG_ERROR("guidance not withdrawn", "robot", robot.name, "reason", withdrawn.error().text);
  }
  if (segments_) segments_->Skip(robot.name, 0);
  attention_.Hear(*store_.FindGuidance(robot.name), OperatorTime());
  PublishGuidance(robot);
}

SimTime OperatorService::TimeOf(const std::string& world) const {
  SimTime newest;
  for (const auto& robot : robots_) {
    if (robot->world == world && robot->stamp) newest = std::max(newest, *robot->stamp);
  }
  return newest;
}

SimTime OperatorService::OperatorTime() const {
  SimTime newest = newest_clock_;
  for (const auto& world : worlds_) newest = std::max(newest, TimeOf(world->name));
  return newest;
}

}  // namespace conav::operators
