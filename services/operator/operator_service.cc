#include "operator/operator_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <set>
#include <utility>

#include "common/grid/map_accuracy.h"
#include "common/msg/convert.h"
#include "common/service/robot_list.h"

/// Parts of operator_service*.cc only: the topics of one world, and those of one robot.
namespace conav::operators {

struct OperatorService::WorldLink {
  WorldLink(bus::Participant& participant, const std::string& name)
      : name(name), initial_map(participant, bus::kInitialMap, name) {}

  bool served() const { return belief.has_value(); }

  std::string name;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> initial_map;
  std::optional<bus::Publisher<conav_msgs::msg::BeliefMap>> belief;  // while it is served
  std::optional<bus::Publisher<nav_msgs::msg::OccupancyGrid>> belief_map;
  double cell_size_m = 0.0;
  BeliefGrid initial;                // while it is served
  std::optional<MapUpdate> pending;  // initial map that is not stored yet
  std::string refusal;               // why the newest initial map is not served; empty otherwise
};

struct OperatorService::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, const std::string& world)
      : name(name),
        world(world),
        state(participant, bus::kRobotState, name),
        attention(participant, bus::kAttention, name),
        drive(participant, bus::kDriveOrder, name) {}

  std::string name;
  std::string world;
  bus::Subscriber<conav_msgs::msg::RobotState> state;
  bus::Subscriber<conav_msgs::msg::AttentionRequest> attention;
  bus::Publisher<conav_msgs::msg::DriveOrder> drive;
  std::optional<bus::Publisher<conav_msgs::msg::Guidance>> guidance;  // while its world is served
  std::optional<SimTime> stamp;                                       // of the newest state
  std::optional<RobotState> first_state;  // of a run that was not greeted yet
  std::uint64_t asked = 0;                // attention requests heard
};

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
  console_->Receive(services_.services());
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
    console_->Receive(attention_.published());
  }
  if (control_.book().version() != control_shown_) {
    control_shown_ = control_.book().version();
    console_->Receive(control_.book());
  }
  const std::vector<Alert> alerts = alerts_.TakeChanges();
  for (const Alert& alert : alerts) console_->Receive(alert);
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
    if (guidance != nullptr) attention_.Receive(*guidance, OperatorTime());
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
  if (console_) console_->Receive(*belief, world.initial);
}

void OperatorService::PublishGuidance(RobotLink& robot) {
  const Guidance* guidance = store_.FindGuidance(robot.name);
  if (robot.guidance && guidance != nullptr && guidance->world == robot.world) {
    bus::Send(*robot.guidance, ToMessage(*guidance));
    if (console_) console_->Receive(*guidance);
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
    if (console_) console_->ReceiveGeometry(world.name, *world.pending);
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
    drive_gate_.Receive(state);
    if (segments_) segments_->Receive(state);
    if (task_) task_->Receive(state);
    if (console_) console_->Receive(stamped);
    attention_.Receive(state, OperatorTime());
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
    attention_.Receive(request, OperatorTime());
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

namespace {

/// Pages' requests that wait for the map of their world.
constexpr std::size_t kWaitingLimit = 64;

/// Low-level actions and selections are void as soon as they are old, and are not stored.
bool IsStored(const OperatorRequest& request) {
  return !std::holds_alternative<DriveRequest>(request.body) &&
         !std::holds_alternative<SelectRequest>(request.body);
}

/// Edits, guides or answers.
bool IsOfWorld(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body);
}

OperatorReply Refusal(const OperatorRequest& request, std::string why) {
  return {request.client, request.request_id, false, std::move(why), 0};
}

/// Of a request that guides or answers.
const std::string& GuidedRobot(const OperatorRequest& request) {
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  return answer != nullptr ? answer->robot : std::get<GuideRequest>(request.body).robot;
}

}  // namespace

// --- where they come from --------------------------------------------------------------------

void OperatorService::AnswerBus() {
  const std::vector<OperatorRequest> requests =
      requests_.TakeValid([](const auto& message) { return ToDomain(message); });
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto reply = Answer(requests[i], "", ReplacedBy(requests, i));
    if (reply) bus::Send(replies_, ToMessage(*reply));
  }
}

void OperatorService::AnswerConsole() {
  std::vector<ConsoleTopics::Asked> asked = std::exchange(waiting_, {});
  std::ranges::move(console_->Step(), std::back_inserter(asked));
  // After Step(): who is back by now has not gone.
  for (const std::string& client : console_->TakeGone()) control_.Leave(client);
  for (const std::string& client : console_->TakeActive()) control_.Renew(client);
  std::vector<OperatorRequest> requests;
  for (ConsoleTopics::Asked& one : asked) requests.push_back(std::move(one.request));
  for (std::size_t i = 0; i < asked.size(); ++i) {
    OperatorRequest& request = requests[i];
    const auto reply = Answer(request, asked[i].why_not, ReplacedBy(requests, i));
    const bool may_wait = WallSeconds() <= asked[i].valid_until_s;
    if (!reply && may_wait && waiting_.size() < kWaitingLimit) {
      asked[i].request = std::move(request);
      waiting_.push_back(std::move(asked[i]));
      continue;
    }
    console_->Reply(asked[i].page,
                    reply ? *reply
                          : Refusal(request, fmt::format("world {} is not known yet: its map has "
                                                         "not come",
                                                         request.world)));
  }
}

// --- what is decided -------------------------------------------------------------------------

std::optional<OperatorReply> OperatorService::Answer(const OperatorRequest& request,
                                                     std::string_view why_not,
                                                     const OperatorRequest* replaced_by) {
  if (IsStored(request)) {
    if (const auto repeat = store_.FindRepeat(request)) {
      NoteStorage(*repeat);
      return repeat->reply;
    }
  }
  if (!why_not.empty()) return Publish(request, {Refusal(request, std::string(why_not))});
  if (IsOfWorld(request)) {
    const WorldLink* world = FindWorld(request.world);
    if (world != nullptr && !world->served() && world->refusal.empty()) return std::nullopt;
  }
  std::string why = control_.CheckAllowed(request);
  if (why.empty() && task_) why = task_->CheckAllowed(request);
  if (!why.empty()) return Publish(request, {Refusal(request, std::move(why))});
  control_.Renew(request.client);
  return Decide(request, replaced_by);
}

OperatorReply OperatorService::Decide(const OperatorRequest& request,
                                      const OperatorRequest* replaced_by) {
  if (AlertTopics::Handles(request))
    return Publish(request, alerts_.Answer(request, WallSeconds()));
  if (ControlTopics::Handles(request)) {
    return Publish(request, control_.Answer(request, OperatorTime()));
  }
  if (std::holds_alternative<FinishRequest>(request.body)) return Publish(request, Finish(request));
  if (std::holds_alternative<DriveRequest>(request.body)) return PassOn(request, replaced_by);
  if (std::holds_alternative<SelectRequest>(request.body)) {
    return Publish(request, {attention_.Select(request, OperatorTime())});
  }
  const WorldLink* world = FindWorld(request.world);
  if (world != nullptr && !world->served())
    return Publish(request, {Refusal(request, world->refusal)});
  const BeliefStore::Answer answer = store_.Handle(request, TimeOf(request.world));
  if (answer.changed) PublishChange(request);
  if (answer.changed && segments_) Record(request);
  return Publish(request, answer);
}

OperatorReply OperatorService::PassOn(const OperatorRequest& request,
                                      const OperatorRequest* replaced_by) {
  if (replaced_by != nullptr) {
    return Publish(request,
                   {Refusal(request, fmt::format("replaced by request {}, which came at once",
                                                 replaced_by->request_id))});
  }
  const DriveGate::Answer answer = drive_gate_.Handle(request, TimeOf(request.world), clock_.Now());
  for (const auto& robot : robots_) {
    if (answer.order && robot->name == answer.order->robot) {
      bus::Send(robot->drive, ToMessage(*answer.order));
    }
  }
  return Publish(request, {answer.reply});
}

// --- who hears of it -------------------------------------------------------------------------

void OperatorService::PublishChange(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    attention_.Edited(request.client, request.world, OperatorTime());
    if (WorldLink* world = FindWorld(request.world)) PublishBelief(*world);
    return;
  }
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  const std::string& name = GuidedRobot(request);
  if (console_ && answer != nullptr) console_->Receive(*answer, request.client);
  attention_.Guided(request.client, *store_.FindGuidance(name), OperatorTime());
  for (const auto& robot : robots_) {
    if (robot->name == name) PublishGuidance(*robot);
  }
}

void OperatorService::Record(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    segments_->Edited(*store_.FindBelief(request.world));
  } else {
    segments_->Guided(*store_.FindGuidance(GuidedRobot(request)));
  }
}

OperatorReply OperatorService::Publish(const OperatorRequest& request,
                                       const BeliefStore::Answer& answer) {
  NoteStorage(answer);
  const bool is_news = journal_.Note(request, answer, TimeOf(request.world));
  if (console_ && is_news) console_->Receive(request, answer.reply);
  return answer.reply;
}

void OperatorService::NoteStorage(const BeliefStore::Answer& answer) {
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
    if (!world->refusal.empty()) {
      health.level = Health::Level::kError;
      health.message = world->refusal;
    }
    health.values.emplace_back(fmt::format("{} belief revision", world->name),
                               belief == nullptr ? "none" : std::to_string(belief->revision));
  }
  for (const auto& robot : robots_) {
    const Guidance* guidance = store_.FindGuidance(robot->name);
    health.values.emplace_back(fmt::format("{} guidance revision", robot->name),
                               std::to_string(guidance == nullptr ? 0 : guidance->revision));
    health.values.emplace_back(fmt::format("{} attention requests", robot->name),
                               std::to_string(robot->asked));
    const std::string driver = drive_gate_.DriverOf(robot->name, clock_.Now());
    health.values.emplace_back(fmt::format("{} steered by", robot->name),
                               driver.empty() ? "nobody" : driver);
  }
  health.values.emplace_back("matters in the attention queue",
                             std::to_string(attention_.items().size()));
  health.values.emplace_back("requests accepted", std::to_string(journal_.accepted()));
  health.values.emplace_back("requests refused", std::to_string(journal_.refused()));
  if (segments_) {
    health.values.emplace_back("segments recorded", std::to_string(segments_->recorded()));
    health.values.emplace_back("segments lost", std::to_string(segments_->lost()));
    health.values.emplace_back("pictures lost", std::to_string(segments_->lost_pictures()));
  }
  if (storage_failure_ && !storage_failure_->empty()) {
    health.level = Health::Level::kError;
    health.message = *storage_failure_;
  }
  return health;
}

}  // namespace conav::operators

/// The service's part in a mapping task or a study; see TaskTopics.
namespace conav::operators {

BeliefStore::Answer OperatorService::Finish(const OperatorRequest& request) {
  if (!task_) return {{request.client, request.request_id, false, "there is no task here", 0}};
  const bool was_finished = task_->finished();
  BeliefStore::Answer answer = task_->Finish(request);
  if (task_->finished() && !was_finished && segments_) segments_->Finish();
  return answer;
}

void OperatorService::FollowTask() {
  task_->Receive(control_.book());
  TaskStatus status = task_->status();
  if (!console_ || status == task_shown_) return;
  console_->Receive(status);
  task_shown_ = std::move(status);
}

}  // namespace conav::operators
