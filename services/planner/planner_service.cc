#include "planner/planner_service.h"

#include <thread>

#include "common/msg/convert.h"
#include "common/runtime/random.h"
#include "common/service/robot_list.h"
#include "common/service/robot_state_topics.h"
#include "planner/methods/make_method.h"
#include "planner/robot_actions.h"

namespace conav::planner {
namespace {

DecisionLog OpenLog(const std::filesystem::path& file) {
  auto log = DecisionLog::Open(file);
  if (!log) throw StartupError("planner.decision_file: " + log.error().text);
  return *std::move(log);
}

DecisionRecord RecordOf(const Decision& decision, const Situation& situation) {
  DecisionRecord record;
  record.report = decision.report;
  record.map = situation.map.cells;
  record.belief = situation.belief.wall_probability;
  record.goals_left = situation.state.goals_left;
  record.path = situation.state.path;
  if (situation.guidance) record.guidance = situation.guidance->path;
  record.plan = decision.plan;
  record.taken.kind = decision.action->kind;
  record.taken.target = decision.action->target;
  record.taken.heading_rad = decision.action->heading_rad;
  return record;
}

}  // namespace

DecisionRecording::DecisionRecording(const std::filesystem::path& file) : log_(OpenLog(file)) {}

void DecisionRecording::Record(const Decision& decision, const Situation& situation) {
  const DecisionRecord record = RecordOf(decision, situation);
  const std::lock_guard lock(mutex_);
  if (const auto written = log_.Append(record); !written) {
    ++lost_;
    if (const auto held_back = failures_logged_.Allow()) {
      LOG_ERROR("decision not recorded", "reason", written.error().text, "held_back", *held_back);
    }
    return;
  }
  ++recorded_;
}

namespace {

constexpr std::chrono::milliseconds kReceivePause{100};

/// Hands each value that came on a topic, converted and checked, to `take`.
template <class Subscriber, class Take>
void Drain(Subscriber& subscriber, Take&& take) {
  for (auto& value : subscriber.TakeValid(kToDomain)) take(std::move(value));
}

}  // namespace

struct PlannerService::Link {
  Link(bus::Participant& participant, const std::string& name, Blackboard& board)
      : robot(name),
        command(participant, bus::kRobotCommand, name),
        report(participant, bus::kSearchReport, name),
        plan(participant, bus::kPlan, name),
        attention(participant, bus::kAttention, name),
        attentions(participant, bus::kAttention, name),
        state(participant, name),
        map(participant, bus::kRobotMap, bus::kRobotMapChanges, name),
        guidance(participant, bus::kGuidance, name),
        drive(participant, bus::kDriveOrder, name),
        stop(participant, bus::kStopOrder, name),
        goal_pose(participant, bus::kGoalPose, name),
        camera_info(participant, bus::kCameraInfo, name),
        actions(participant, name, board) {}

  std::string robot;
  bus::Publisher<conav_msgs::msg::RobotCommand> command;
  bus::Publisher<conav_msgs::msg::SearchReport> report;
  bus::Publisher<nav_msgs::msg::Path> plan;
  bus::Publisher<conav_msgs::msg::AttentionRequest> attention;
  bus::Subscriber<conav_msgs::msg::AttentionRequest> attentions;  // of any planner
  RobotStateTopics state;
  bus::ChangesSubscriber<nav_msgs::msg::OccupancyGrid> map;
  bus::Subscriber<conav_msgs::msg::Guidance> guidance;
  bus::Subscriber<conav_msgs::msg::DriveOrder> drive;
  bus::Subscriber<conav_msgs::msg::StopOrder> stop;
  bus::Subscriber<geometry_msgs::msg::PoseStamped> goal_pose;
  bus::Subscriber<sensor_msgs::msg::CameraInfo> camera_info;
  RobotActions actions;
};

PlannerService::PlannerService(bus::Participant& participant, const PlannerConfig& config,
                               const Clock& clock)
    : participant_(participant),
      config_(config),
      board_(WorldOfRobot("planner", config.robots)),
      perception_(participant, config, clock),
      leases_(participant, config, WorldOfRobot("planner", config.robots), board_, clock),
      diagnostics_(participant, clock) {
  if (!config.decision_file.empty()) recording_.emplace(config.decision_file);
  std::map<std::string, PerceptionOfWorld> worlds;
  for (const auto& [robot, world] : WorldOfRobot("planner", config.robots)) {
    PerceptionOfWorld& in_world = worlds[world];
    if (!in_world.model) in_world = MakePerceptionOfWorld(world);
    links_.push_back(std::make_unique<Link>(participant, robot, board_));
    const std::uint64_t seed = DeriveSeed(config.seed, links_.size());
    auto method = MakeMethod(config.method, {config.search, config.communication}, seed,
                             in_world.model, in_world.estimate, clock);
    RobotWorker::Options options{
        .robot = robot,
        .method_name = std::string(Name(config.method)),
        .timeouts = {Seconds(config.first_guidance_timeout_s), Seconds(config.answer_timeout_s)},
        .command_ttl = Seconds(config.command_ttl_s),
        .seed = seed,
        .timeouts_in_simulation_time = config.timeout_clock == "simulation",
        .value_lost = {config.search.options.reward, config.search.options.discount},
        .goal_knowledge = config.goal_knowledge};
    workers_.push_back(std::make_unique<RobotWorker>(std::move(options), std::move(method), board_,
                                                     clock, OutputsOf(*links_.back())));
  }
  for (const auto& [world, perception] : worlds) {
    models_[world] = perception.model;
    beliefs_.push_back(std::make_unique<bus::ChangesSubscriber<conav_msgs::msg::BeliefMap>>(
        participant, bus::kBelief, bus::kBeliefChanges, world));
    if (config.method == MethodKind::kMapping) {
      truths_.try_emplace(world, participant, bus::kTruth, world);
    }
  }
}

PlannerService::~PlannerService() = default;

RobotWorker::Outputs PlannerService::OutputsOf(Link& link) {
  RobotWorker::Outputs outputs{
      .command =
          [&link](const RobotCommand& command) { bus::Send(link.command, ToMessage(command)); },
      .report = [&link](const SearchReport& report) { bus::Send(link.report, ToMessage(report)); },
      .attention =
          [&link](const AttentionRequest& request) {
            bus::Send(link.attention, ToMessage(request));
          },
      .plan =
          [&link, last = std::tuple<std::vector<Cell>, GridGeometry, std::uint64_t>()](
              const RobotState& state, const MapUpdate& map,
              const std::vector<Cell>& plan) mutable {
            // Of a new epoch, too: another planner's plan may stand in between.
            std::tuple next(plan, map.geometry(), state.lease_epoch);
            if (last == next) return;
            last = std::move(next);
            bus::Send(link.plan, ToPathMessage(state.stamp, plan, map.geometry()));
          },
      .intended_path = [this](const IntendedPath& path) { leases_.PublishIntendedPath(path); },
      .decided = {},
      .timed = [this](double duration_ms) { leases_.CountDecision(duration_ms); },
  };
  if (recording_) {
    outputs.decided = [this](const Decision& decision, const Situation& situation) {
      recording_->Record(decision, situation);
    };
  }
  return outputs;
}

void PlannerService::Run(const StopToken& stop) {
  std::vector<std::jthread> threads;
  for (const auto& worker : workers_) {
    threads.emplace_back([&worker, &stop] { worker->Run(stop); });
  }
  while (!stop.stop_requested()) {
    participant_.Wait(kReceivePause);
    Receive();
    diagnostics_.Tick([this] { return Report(); });
  }
  board_.Touch();
  threads.clear();
  for (auto& link : links_) link->actions.End();
  leases_.Leave();
}

void PlannerService::Receive() {
  // Taken first and put last: a worker decides on a new state at once, with all that was sent
  // before it.
  std::vector<RobotState> states;
  for (auto& link : links_) {
    for (auto& state : link->state.TakeStamped()) states.push_back(std::move(state.value));
  }
  const auto put = [&](auto&& value) { board_.Put(std::move(value)); };
  for (auto& belief : beliefs_) Drain(*belief, put);
  for (auto& [world, truth] : truths_) {
    const std::string& name = world;
    Drain(truth, [&](MapUpdate&& value) { board_.PutTruth(name, value.cells); });
  }
  for (auto& link : links_) {
    const std::string& robot = link->robot;
    Drain(link->guidance, put);
    Drain(link->stop, put);
    Drain(link->drive, put);
    Drain(link->camera_info, [&](const CameraLens& value) { board_.PutLens(robot, value); });
    Drain(link->map, [&](MapUpdate&& value) { board_.PutMap(robot, std::move(value)); });
    Drain(link->attentions, [&](const AttentionRequest& value) {
      board_.ReceivedAttention(robot, value.sequence_number);
    });
    Drain(link->goal_pose, [&](Position value) { board_.PutRoute(robot, {value}); });
    link->actions.Turn();
  }
  for (const RobotState& state : states) leases_.Receive(state);
  leases_.Turn();
  for (RobotState& state : states) board_.Put(std::move(state));
}

Health PlannerService::Report() const {
  Health health;
  for (const auto& link : links_) {
    const RobotInputs inputs = board_.Read(link->robot);
    if (!inputs.state) health.level = Health::Level::kWarning;
    health.values.emplace_back(
        link->robot,
        inputs.state ? fmt::format("at {}, {} goals left, {}, waits for {}{}", inputs.state->cell,
                                   inputs.state->goals_left.size(), leases_.Describe(link->robot),
                                   board_.BlockedReasonOf(link->robot),
                                   inputs.route ? "; a goal waits for it" : "")
                     : "no state yet");
  }
  health.values.emplace_back("decisions", std::to_string(leases_.decisions()));
  for (const auto& [world, model] : models_) {
    health.values.emplace_back("perception_model_" + world, model->identity().name);
  }
  if (recording_) {
    health.values.emplace_back("recorded_decisions", std::to_string(recording_->recorded()));
    health.values.emplace_back("lost_decisions", std::to_string(recording_->lost()));
    if (recording_->lost() > 0) health.level = Health::Level::kWarning;
  }
  health.message = fmt::format("{} of {} robots, {} planners, method {}", leases_.held(),
                               links_.size(), leases_.live_planners(), Name(config_.method));
  return health;
}

}  // namespace conav::planner
