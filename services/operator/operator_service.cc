#include <fmt/format.h>

#include <algorithm>
#include <array>
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
constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

BeliefStoreOptions StoreOptions(const OperatorConfig& config) {
  const auto limit = static_cast<std::int64_t>(config.database_limit_mib * 1024.0 * 1024.0);
  return {{config.database, limit}, {config.max_guidance_s, config.max_path_cells}};
}

/// In the order of OperatorRequest::body.
constexpr std::array kKinds{"edit",   "guide", "drive",        "select",          "answer",
                            "stop",   "go",    "take_control", "release_control", "acknowledge",
                            "shelve", "finish"};
static_assert(kKinds.size() == std::variant_size_v<decltype(OperatorRequest::body)>);

const char* KindOf(const OperatorRequest& request) { return kKinds[request.body.index()]; }

/// Of a request that guides or answers.
const std::string& GuidedRobot(const OperatorRequest& request) {
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  return answer != nullptr ? answer->robot : std::get<GuideRequest>(request.body).robot;
}

}  // namespace

OperatorService::OperatorService(bus::Participant& participant, const OperatorConfig& config,
                                 const Clock& clock)
    : participant_(participant),
      clock_(clock),
      store_(StoreOptions(config)),
      control_(participant, config, store_, clock),
      drive_desk_(WorldOfRobot("operator", config.robots), {}),
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
    recording_.emplace(participant, config.recording, WorldOfRobot("operator", config.robots),
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
  if (recording_) recording_->Step();
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
  alerts_.Update(
      ConditionsOf(attention_.items(), services_.services(), storage_failure_.value_or("")),
      WallSeconds());
  if (!console_) return;
  console_->Hear(services_.services());
  console_->SetReadiness(Report());
}

void OperatorService::AnswerBus() {
  const std::vector<OperatorRequest> requests = requests_.TakeValid(kConvert);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto reply = Answer(requests[i], ReplacedBy(requests, i));
    if (reply) bus::Send(replies_, ToMessage(*reply));
  }
}

void OperatorService::AnswerConsole() {
  for (const std::string& client : console_->TakeGone()) control_.Leave(client);
  for (const ConsoleDesk::Asked& asked : console_->Step()) {
    const OperatorRequest& request = asked.request;
    const auto reply = Answer(request, nullptr);
    console_->Reply(
        asked.page,
        reply.value_or(OperatorReply{
            request.client, request.request_id, false,
            fmt::format("world {} is not known yet: wait for its map", request.world), 0}));
  }
}

void OperatorService::ShowOnConsole() {
  if (attention_.published().revision != attention_shown_) {
    attention_shown_ = attention_.published().revision;
    console_->Hear(attention_.published());
  }
  if (control_.desk().version() != control_shown_) {
    control_shown_ = control_.desk().version();
    console_->Hear(control_.desk());
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
  if (recording_) recording_->Begin(*store_.FindBelief(world.name));
  for (const auto& robot : robots_) {
    if (robot->world != world.name) continue;
    const Guidance* guidance = store_.FindGuidance(robot->name);
    if (recording_ && guidance != nullptr) {
      recording_->Skip(robot->name, guidance->answers_snapshot);
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
  storage_failure_.reset();
  if (added) {
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
  for (const RobotState& state : robot.state.TakeValid(kConvert)) {
    if (state.world != robot.world) {
      LOG_WARNING("state of another world ignored", "robot", robot.name, "world", state.world,
                  "configured", robot.world);
      continue;
    }
    const bool starts = !robot.stamp || state.stamp < *robot.stamp;
    robot.stamp = state.stamp;
    drive_desk_.Hear(state);
    if (recording_) recording_->Hear(state);
    if (task_) task_->Hear(state);
    if (console_) console_->Hear(state);
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
  if (recording_) recording_->Skip(robot.name, 0);
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

std::optional<OperatorReply> OperatorService::Answer(const OperatorRequest& request,
                                                     const OperatorRequest* replaced_by) {
  const auto reply_of = [&](const BeliefStore::Answer& answer) {
    Log(request, answer);
    return answer.reply;
  };
  if (AlertDesk::Handles(request)) return reply_of(alerts_.Answer(request, WallSeconds()));
  if (RobotControl::Handles(request)) return reply_of(control_.Answer(request, OperatorTime()));
  if (std::holds_alternative<FinishRequest>(request.body)) return reply_of(Finish(request));
  std::string why = control_.WhyNot(request);
  if (why.empty() && task_) why = task_->WhyNot(request);
  if (!why.empty()) {
    return reply_of({{request.client, request.request_id, false, std::move(why), 0}});
  }
  control_.Renew(request.client);
  if (std::holds_alternative<DriveRequest>(request.body)) return PassOn(request, replaced_by);
  if (std::holds_alternative<SelectRequest>(request.body)) {
    return reply_of({attention_.Select(request, OperatorTime())});
  }
  const WorldLink* world = FindWorld(request.world);
  if (world != nullptr && !world->served() && world->refusal.empty()) return std::nullopt;
  return AnswerStored(request, world);
}

OperatorReply OperatorService::AnswerStored(const OperatorRequest& request,
                                            const WorldLink* world) {
  const BeliefStore::Answer answer =
      world != nullptr && !world->served()
          ? BeliefStore::Answer{{request.client, request.request_id, false, world->refusal, 0}}
          : store_.Handle(request, TimeOf(request.world));
  Log(request, answer);
  if (answer.changed) PublishChange(request);
  if (answer.changed && recording_) Record(request);
  return answer.reply;
}

OperatorReply OperatorService::PassOn(const OperatorRequest& request,
                                      const OperatorRequest* replaced_by) {
  if (replaced_by != nullptr) {
    ++refused_;
    return {request.client, request.request_id, false,
            fmt::format("replaced by request {}, which came at once", replaced_by->request_id), 0};
  }
  const DriveDesk::Answer answer = drive_desk_.Handle(request, TimeOf(request.world), clock_.Now());
  ++(answer.reply.accepted ? accepted_ : refused_);
  if (!answer.reply.accepted) {
    LOG_WARNING("refused", "kind", "drive", "client", request.client, "id", request.request_id,
                "world", request.world, "reason", answer.reply.reason);
  }
  for (const auto& robot : robots_) {
    if (answer.order && robot->name == answer.order->robot) {
      bus::Send(robot->drive, ToMessage(*answer.order));
    }
  }
  return answer.reply;
}

void OperatorService::PublishChange(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    attention_.Edited(request.client, request.world, OperatorTime());
    if (WorldLink* world = FindWorld(request.world)) PublishBelief(*world);
    return;
  }
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  const std::string& name = GuidedRobot(request);
  if (console_ && answer != nullptr) console_->Hear(*answer, request.client);
  attention_.Guided(request.client, *store_.FindGuidance(name), OperatorTime());
  for (const auto& robot : robots_) {
    if (robot->name == name) PublishGuidance(*robot);
  }
}

void OperatorService::Record(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    recording_->Edited(*store_.FindBelief(request.world));
  } else {
    recording_->Guided(*store_.FindGuidance(GuidedRobot(request)));
  }
}

void OperatorService::Log(const OperatorRequest& request, const BeliefStore::Answer& answer) {
  const OperatorReply& reply = answer.reply;
  ++(reply.accepted ? accepted_ : refused_);
  const bool is_stored = !std::holds_alternative<SelectRequest>(request.body);
  if (is_stored) storage_failure_.reset();
  if (answer.storage_failed) storage_failure_ = reply.reason;
  if (console_ && (answer.changed || !reply.accepted)) console_->Hear(request, reply);
  const char* kind = KindOf(request);
  if (reply.accepted) {
    LOG_INFO("accepted", "kind", kind, "client", request.client, "id", request.request_id, "world",
             request.world, "revision", reply.revision, "new", answer.changed, "sim_s",
             TimeOf(request.world).ToSeconds());
  } else {
    LOG_WARNING("refused", "kind", kind, "client", request.client, "id", request.request_id,
                "world", request.world, "reason", reply.reason);
  }
}

}  // namespace conav::operators
