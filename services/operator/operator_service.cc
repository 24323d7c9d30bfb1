#include "operator/operator_service.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "common/grid/map_accuracy.h"
#include "common/msg/convert.h"
#include "common/service/robot_state_topics.h"
#include "operator/supervision/command_log.h"

namespace conav::operators {

/// The topics of one robot.
struct OperatorService::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, const std::string& world)
      : name(name),
        world(world),
        state(participant, name, RobotStateTopics::Rate::kThrottledOverLinks),
        attention(participant, bus::kAttention, name),
        drive(participant, bus::kDriveOrder, name) {}

  std::string name;
  std::string world;
  RobotStateTopics state;
  bus::Subscriber<conav_msgs::msg::AttentionRequest> attention;
  bus::Publisher<conav_msgs::msg::DriveOrder> drive;
  std::optional<bus::Subscriber<conav_msgs::msg::Snapshot>> snapshot;  // for pages and recording
  std::optional<bus::Publisher<conav_msgs::msg::Guidance>> guidance;   // while its world is served
  std::optional<SimTime> stamp;                                        // of the newest state
  Clock::TimePoint received_at{};                                      // likewise
  std::optional<RobotState> first_state;  // of a new run, until its guidance was checked
  std::string map_problem;                // why its states are not used; empty = they are
  std::uint64_t attention_requests = 0;   // received
  bool IsLost(Clock::TimePoint now) const {
    return state.matched_publishers() == 0 || (stamp && now - received_at > kLostAfter);
  }
};

namespace {

constexpr std::chrono::milliseconds kHealthPeriod{250};
constexpr std::chrono::seconds kForgetPeriod{10};
/// No client repeats a request for so long: those of pages expire within seconds, others give up.
constexpr double kRequestsKeptS = 86400.0;
constexpr std::int64_t kForgottenAtOnce = 200;
constexpr std::size_t kWaitingLimit = 64;  // pages' requests that wait for the map of their world

/// The link of that name; null when it is not supervised here.
template <class Links>
auto* Find(const Links& links, const std::string& name) {
  const auto found =
      std::ranges::find_if(links, [&](const auto& link) { return link->name == name; });
  return found == links.end() ? nullptr : found->get();
}

BeliefStoreOptions StoreOptions(const OperatorConfig& config) {
  const auto limit = static_cast<std::int64_t>(config.database_limit_mib * 1024.0 * 1024.0);
  return {{config.database, limit}, {config.max_guidance_s, config.max_path_cells}};
}

template <class Value>
void Add(Health& health, std::string key, const Value& value) {
  health.values.emplace_back(std::move(key), fmt::format("{}", value));
}

}  // namespace

OperatorService::OperatorService(bus::Participant& participant, const OperatorConfig& config,
                                 const Clock& clock)
    : participant_(participant),
      clock_(clock),
      store_(StoreOptions(config)),
      control_(participant, config, store_, clock),
      drive_gate_(config.world_of_robot()),
      requests_(participant, clock),
      replies_(participant, bus::kOperatorReply),
      events_(participant, bus::kOperatorEvent),
      clock_topic_(participant, bus::Sparse(bus::kClock)),
      attention_(participant, config.attention, clock),
      services_(participant, clock),
      goals_(participant, config, store_, clock),
      alerts_(store_, participant),
      ros_services_(participant, config.world_of_robot(),
                    std::filesystem::path(config.database).parent_path()),
      diagnostics_(participant, clock) {
  const auto world_of_robot = config.world_of_robot();
  for (const auto& [robot, world] : world_of_robot) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot, world));
    if (Find(worlds_, world) != nullptr) continue;
    worlds_.push_back(std::make_unique<WorldTopics>(participant, world));
  }
  if (!config.recording.file.empty()) {
    segments_.emplace(participant, config.recording, world_of_robot, clock);
  }
  if (config.task.on()) task_.emplace(participant, config, store_, clock);
  if (config.console.on()) console_.emplace(participant, config, services_, clock);
  if (config.foxglove.on()) foxglove_.emplace(participant, config, clock);
  for (const auto& robot : robots_) {
    if (segments_ || console_) robot->snapshot.emplace(participant, bus::kSnapshot, robot->name);
  }
}

OperatorService::~OperatorService() = default;

void OperatorService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    participant_.Wait(std::chrono::milliseconds(100));
    Step();
  }
}

void OperatorService::Step() {
  for (const auto& world : worlds_) ReceiveInitialMap(*world);
  ReceiveClock();
  for (const auto& robot : robots_) ReceiveStates(*robot);
  for (const auto& robot : robots_) {
    ReceiveAttention(*robot);
    if (robot->snapshot) ReceiveSnapshots(*robot);
  }
  if (segments_) segments_->Step();
  if (task_) task_->Step();
  AnswerClients();
  AnswerPages();
  goals_.Step(control_.registry());
  attention_.Step(OperatorTime());
  control_.Step();
  services_.Step();
  if (clock_.Now() >= health_due_at_) UpdateHealth();
  if (task_) ServeTask();
  if (console_) UpdateConsole();
  diagnostics_.Tick([this] { return Report(); });
}

void OperatorService::UpdateHealth() {
  health_due_at_ = clock_.Now() + kHealthPeriod;
  std::vector<RobotCondition> robots;
  for (const auto& robot : robots_) {
    goals_.CountPublishers(robot->name, robot->state.goal_publishers());
    if (!robot->stamp) continue;
    robots.push_back({.name = robot->name,
                      .lost = robot->IsLost(clock_.Now()),
                      .stands = Stands(attention_.items(), robot->name),
                      .resumed_elsewhere = control_.TakeResumedElsewhere(robot->name),
                      .stop_unconfirmed = control_.IsStopUnconfirmed(robot->name),
                      .map_problem = robot->map_problem,
                      .goals_problem = goals_.ProblemOf(robot->name)});
  }
  alerts_.Update(robots, services_, storage_failure_, WallSeconds());
  if (clock_.Now() >= forget_due_at_) ForgetOldRequests();
  if (foxglove_) foxglove_->Receive(services_.services());
  if (!console_) return;
  console_->ReceiveServices();
  console_->SetReadiness(Report());
}

void OperatorService::ForgetOldRequests() {
  forget_due_at_ = clock_.Now() + kForgetPeriod;
  const auto forgotten = store_.ForgetRequests(WallSeconds() - kRequestsKeptS, kForgottenAtOnce);
  if (!forgotten) LOG_WARNING("old requests not removed", "reason", forgotten.error().text);
}

void OperatorService::UpdateConsole() {
  const AttentionQueueState& queue = attention_.published();
  const ControlRegistry& control = control_.registry();
  if (std::exchange(attention_shown_, queue.revision) != queue.revision) console_->Receive(queue);
  if (std::exchange(control_shown_, control.version()) != control.version()) {
    console_->Receive(control);
  }
  for (const Alert& alert : alerts_.TakeChanges()) console_->Receive(alert);
  console_->Publish();
}

void OperatorService::Serve(WorldTopics& world, const MapUpdate& initial_map) {
  store_.Place(world.name, initial_map.geometry());
  if (console_) console_->ReceiveGeometry(world.name, initial_map);
  world.Serve();
  PublishBelief(world);
  if (segments_) segments_->Begin(*store_.FindBelief(world.name));
  for (const auto& robot : robots_) {
    if (robot->world != world.name) continue;
    const Guidance* guidance = store_.FindGuidance(robot->name);
    if (segments_ && guidance) segments_->Skip(robot->name, guidance->answers_snapshot);
    if (guidance != nullptr) attention_.Receive(*guidance, OperatorTime());
    if (!robot->guidance) robot->guidance.emplace(participant_, bus::kGuidance, robot->name);
    PublishGuidance(*robot);
  }
}

void OperatorService::StopServing(WorldTopics& world, std::string reason) {
  world.Refuse(std::move(reason));
  for (const auto& robot : robots_) {
    if (robot->world == world.name) robot->guidance.reset();
  }
}

void OperatorService::PublishBelief(WorldTopics& world) {
  const Belief* belief = store_.FindBelief(world.name);
  if (belief == nullptr || !world.served()) return;
  world.Publish(*belief);
  if (console_) console_->Receive(*belief, world.initial());
}

void OperatorService::PublishGuidance(RobotLink& robot) {
  const Guidance* guidance = store_.FindGuidance(robot.name);
  if (robot.guidance && guidance != nullptr && guidance->world == robot.world) {
    bus::Send(*robot.guidance, ToMessage(*guidance));
    if (console_) console_->Receive(*guidance);
  }
}

void OperatorService::ReceiveInitialMap(WorldTopics& world) {
  const MapUpdate* map = world.TakeInitialMap();
  if (map == nullptr) return;
  const auto added = store_.AddWorld(world.name, ToBelief(map->cells), map->stamp);
  if (!added && added.error().code == ErrorCode::kIo) {
    storage_failure_ = added.error().text;  // the map stays pending; the next step tries again
    return;
  }
  if (added) {
    if (*added) storage_failure_ = "";
    LOG_INFO("world", "world", world.name, "new", *added, "revision",
             store_.FindBelief(world.name)->revision);
    Serve(world, *map);
  } else {
    LOG_ERROR("initial map refused", "world", world.name, "reason", added.error().text);
    StopServing(world, added.error().text);
  }
}

void OperatorService::ReceiveStates(RobotLink& robot) {
  for (const auto& stamped : robot.state.TakeStamped()) {
    const RobotState& state = stamped.value;
    if (state.world != robot.world) {
      LOG_WARNING("state of another world ignored", "robot", robot.name, "world", state.world,
                  "configured", robot.world);
      continue;
    }
    const bool starts = !robot.stamp || state.stamp < *robot.stamp;
    robot.stamp = state.stamp;
    robot.received_at = clock_.Now();
    control_.Receive(state);
    if (!HasUsableMap(robot, state)) continue;
    drive_gate_.Receive(state);
    goals_.Receive(state, robot.state.goal_publishers());
    if (segments_) segments_->Receive(state);
    if (task_) task_->Receive(state);
    if (console_) console_->Receive(stamped);
    attention_.Receive(state, OperatorTime());
    if (!starts) continue;
    store_.AddRobot(robot.name, robot.world);
    robot.first_state = state;
  }
  // Before the world is known to be the stored one, nothing stored is changed.
  const WorldTopics* world = Find(worlds_, robot.world);
  if (robot.first_state && world != nullptr && world->served()) {
    CheckGuidance(robot, *robot.first_state);
    robot.first_state.reset();
  }
}

bool OperatorService::HasUsableMap(RobotLink& robot, const RobotState& state) const {
  std::string problem = Find(worlds_, robot.world)->CheckAligned(robot.name, state.grid);
  if (problem != robot.map_problem) {
    if (!problem.empty()) LOG_ERROR("states refused", "robot", robot.name, "reason", problem);
    robot.map_problem = std::move(problem);
  }
  return robot.map_problem.empty();
}

void OperatorService::ReceiveAttention(RobotLink& robot) {
  if (robot.IsLost(clock_.Now())) attention_.LoseLink(robot.name, OperatorTime());
  if (robot.attention.matched_publishers() == 0) attention_.LosePlanner(robot.name, OperatorTime());
  for (const AttentionRequest& request : robot.attention.TakeValid(kToDomain)) {
    ++robot.attention_requests;
    attention_.Receive(request, OperatorTime());
  }
}

void OperatorService::ReceiveSnapshots(RobotLink& robot) {
  for (auto& stamped : robot.snapshot->TakeValidStamped(kToDomain)) {
    if (segments_) segments_->Receive(console_ ? stamped.value : std::move(stamped.value));
    if (console_) console_->Receive(std::move(stamped));
  }
}

void OperatorService::ReceiveClock() {
  for (const auto& message : clock_topic_.Take()) {
    if (const auto time = ToDomain(message.clock())) newest_clock_ = *time;
  }
}

void OperatorService::CheckGuidance(RobotLink& robot, const RobotState& state) {
  const Guidance* guidance = store_.FindGuidance(robot.name);
  if (guidance == nullptr || guidance->answers_snapshot <= state.snapshots) return;
  LOG_WARNING("new run: guidance of the run before withdrawn", "robot", robot.name, "snapshots",
              state.snapshots, "answered", guidance->answers_snapshot);
  if (const auto withdrawn = store_.WithdrawGuidance(robot.name, state.stamp); !withdrawn) {
    LOG_ERROR("guidance not withdrawn", "robot", robot.name, "reason", withdrawn.error().text);
  }
  if (segments_) segments_->Skip(robot.name, 0);
  attention_.Receive(*store_.FindGuidance(robot.name), OperatorTime());
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

void OperatorService::AnswerClients() {
  requests_.ClaimOwn(RosServices::kClient);
  const std::vector<OperatorRequest> requests = requests_.Take(services_);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto reply = Answer(requests[i], "", ReplacedBy(requests, i));
    if (reply) bus::Send(replies_, ToMessage(*reply));
  }
}

void OperatorService::AnswerPages() {
  std::vector<ConsoleTopics::Asked> asked = std::exchange(waiting_, {});
  if (console_) {
    std::ranges::move(console_->Step(), std::back_inserter(asked));
    // After Step(): a client that is back by now has not gone.
    for (const std::string& client : console_->TakeGone()) control_.Leave(client);
    for (const std::string& client : console_->TakeActive()) control_.Renew(client);
  }
  if (foxglove_) {
    std::ranges::move(foxglove_->Step(control_.registry(), OperatorTime()),
                      std::back_inserter(asked));
  }
  std::ranges::move(ros_services_.Step(control_.registry(), clock_.Now()),
                    std::back_inserter(asked));
  std::vector<OperatorRequest> requests;
  for (ConsoleTopics::Asked& one : asked) {
    requests_.ClaimOwn(one.request.client);
    requests.push_back(std::move(one.request));
  }
  for (std::size_t i = 0; i < asked.size(); ++i) {
    OperatorRequest& request = requests[i];
    auto reply = Answer(request, asked[i].refusal, ReplacedBy(requests, i));
    const bool may_wait = WallSeconds() <= asked[i].valid_until_s;
    if (!reply && may_wait && waiting_.size() < kWaitingLimit) {
      asked[i].request = std::move(request);
      waiting_.push_back(std::move(asked[i]));
      continue;
    }
    if (!reply) {
      reply = Refusal(request, fmt::format("the map of {} has not arrived yet", request.world));
    }
    asked[i].reply(*reply);
  }
}

std::optional<OperatorReply> OperatorService::Answer(const OperatorRequest& request,
                                                     std::string refusal,
                                                     const OperatorRequest* replaced_by) {
  if (IsStored(request)) {
    if (const auto repeat = store_.FindRepeat(request)) {
      UpdateStorageFailure(*repeat);
      const bool is_unread = !repeat->storage_failure.empty();
      if (!is_unread || !std::holds_alternative<StopRequest>(request.body)) return repeat->reply;
    }
  }
  const WorldTopics* world = NeedsMap(request) ? Find(worlds_, request.world) : nullptr;
  const bool is_served = world == nullptr || world->served();
  if (refusal.empty() && !is_served && world->refusal().empty()) return std::nullopt;
  if (refusal.empty()) refusal = control_.CheckAllowed(request);
  if (refusal.empty() && task_) refusal = task_->CheckAllowed(request);
  if (refusal.empty()) {
    control_.Renew(request.client);
    if (!is_served) refusal = world->refusal();
    if (replaced_by != nullptr) {
      refusal = fmt::format("replaced by the newer request {}", replaced_by->request_id);
    }
  }
  return Publish(
      request, refusal.empty() ? Decide(request) : BeliefStore::Answer{Refusal(request, refusal)});
}

BeliefStore::Answer OperatorService::Decide(const OperatorRequest& request) {
  if (AlertTopics::Handles(request)) return alerts_.Answer(request, WallSeconds());
  if (FieldGoalTopics::Handles(request)) return goals_.Answer(request);
  if (ControlTopics::Handles(request)) return control_.Answer(request, OperatorTime());
  if (std::holds_alternative<FinishRequest>(request.body)) {
    return task_ ? task_->Finish(request) : BeliefStore::Answer{Refusal(request, "no task here")};
  }
  if (std::holds_alternative<NoteRequest>(request.body)) return store_.Keep(request, {});
  if (std::holds_alternative<DriveRequest>(request.body)) return {HandleDrive(request)};
  if (std::holds_alternative<SelectRequest>(request.body)) {
    return {attention_.Select(request, OperatorTime())};
  }
  BeliefStore::Answer answer = store_.Handle(request, TimeOf(request.world));
  if (answer.changed) PublishChange(request);
  return answer;
}

OperatorReply OperatorService::HandleDrive(const OperatorRequest& request) {
  DriveGate::Answer answer = drive_gate_.Handle(request, TimeOf(request.world), clock_.Now());
  if (answer.order) bus::Send(Find(robots_, answer.order->robot)->drive, ToMessage(*answer.order));
  return std::move(answer.reply);
}

void OperatorService::ServeTask() {
  task_->Receive(control_.registry());
  if (console_) console_->Serve(*task_);
  for (const OperatorRequest& request : task_->TakeRequests()) Answer(request, "", nullptr);
  if (task_->TakeFinished() && segments_) segments_->Finish();
}

void OperatorService::PublishChange(const OperatorRequest& request) {
  const std::string* name = GuidedRobot(request);
  if (name == nullptr) {
    if (WorldTopics* world = Find(worlds_, request.world)) PublishBelief(*world);
    if (segments_) segments_->Edited(*store_.FindBelief(request.world));
    return;
  }
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  if (console_ && answer != nullptr) console_->Receive(*answer, request.client);
  const Guidance& guidance = *store_.FindGuidance(*name);
  attention_.Receive(guidance, OperatorTime());
  PublishGuidance(*Find(robots_, *name));
  if (segments_) segments_->Guided(guidance);
}

OperatorReply OperatorService::Publish(const OperatorRequest& request,
                                       const BeliefStore::Answer& answer) {
  UpdateStorageFailure(answer);
  const bool is_new = request_log_.Note(request, answer, TimeOf(request.world));
  if (!is_new || std::holds_alternative<SelectRequest>(request.body)) return answer.reply;
  if (answer.reply.accepted) {
    const std::string* robot = GuidedRobot(request);
    attention_.Accepted(request.client, robot == nullptr ? request.world : *robot, OperatorTime());
  }
  const OperatorEvent event = EventOf(request, answer.reply, TimeOf(request.world));
  if (task_) task_->Receive(event);
  bus::Send(events_, ToMessage(event));
  if (console_) console_->Receive(event);
  return answer.reply;
}

void OperatorService::UpdateStorageFailure(const BeliefStore::Answer& answer) {
  if (answer.written) storage_failure_ = "";
  if (!answer.storage_failure.empty()) storage_failure_ = answer.storage_failure;
}

Health OperatorService::Report() const {
  Health health{Health::Level::kOk, "serving", {}};
  for (const auto& world : worlds_) {
    const Belief* belief = store_.FindBelief(world->name);
    if (!world->served() && health.level == Health::Level::kOk) {
      health.level = Health::Level::kWarning;
      health.message = fmt::format("waiting for the initial map of world {}", world->name);
    }
    if (!world->refusal().empty()) {
      health.level = Health::Level::kError;
      health.message = world->refusal();
    }
    Add(health, fmt::format("{}/belief_revision", world->name),
        belief ? std::to_string(belief->revision) : "none");
  }
  for (const auto& robot : robots_) {
    const Guidance* guidance = store_.FindGuidance(robot->name);
    const std::string driver = drive_gate_.DriverOf(robot->name, clock_.Now());
    Add(health, fmt::format("{}/guidance_revision", robot->name),
        guidance ? guidance->revision : 0);
    Add(health, fmt::format("{}/attention_requests", robot->name), robot->attention_requests);
    Add(health, fmt::format("{}/driver", robot->name), driver.empty() ? "none" : driver);
  }
  goals_.AddTo(health);
  services_.AddTo(health);
  Add(health, "attention_queue_items", attention_.items().size());
  Add(health, "accepted_requests", request_log_.accepted());
  Add(health, "refused_requests", request_log_.refused());
  if (segments_) segments_->AddTo(health);
  if (foxglove_) foxglove_->AddTo(health);
  if (storage_failure_ && !storage_failure_->empty()) {
    health.level = Health::Level::kError;
    health.message = *storage_failure_;
  }
  return health;
}

}  // namespace conav::operators
