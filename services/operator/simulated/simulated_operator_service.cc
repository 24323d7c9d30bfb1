#include "operator/simulated/simulated_operator_service.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <variant>

#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "common/service/robot_list.h"

namespace conav::operators {
namespace {

/// Passes replies to a synthetic person, and sends its next request.
/// Does not block.
template <class Person>
void AskThrough(OperatorClient& client, Person& person, const Clock& clock) {
  for (const OperatorClient::Outcome& outcome : client.Poll()) {
    if (!outcome.reply) {
      LOG_WARNING("no reply", "reason", outcome.reply.error().text);
    } else if (!outcome.reply->accepted) {
      LOG_WARNING("refused", "id", outcome.request_id, "reason", outcome.reply->reason);
    }
    person.Answered(outcome.reply, clock.Now());
  }
  if (const auto ask = person.Next(clock.Now())) {
    std::visit([&](const auto& body) { client.Send(ask->world, body, ask->stamp); }, ask->body);
  }
}

}  // namespace

struct TeleoperatorTopics::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name)
      : state(participant, bus::kRobotState, name), snapshot(participant, bus::kSnapshot, name) {}

  bus::Subscriber<conav_msgs::msg::RobotState> state;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot;
};

struct TeleoperatorTopics::WorldLink {
  WorldLink(bus::Participant& participant, const std::string& name)
      : name(name),
        belief(participant, bus::kBelief, name),
        belief_map(participant, bus::kBeliefMap, name) {}

  std::string name;
  bus::Subscriber<conav_msgs::msg::BeliefMap> belief;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> belief_map;
};

TeleoperatorTopics::TeleoperatorTopics(bus::Participant& participant, const Clock& clock,
                                       OperatorClient& client,
                                       const SyntheticOperatorParameters& parameters,
                                       std::uint64_t seed,
                                       const std::map<std::string, std::string>& world_of_robot)
    : clock_(clock), client_(client), person_(parameters, seed, world_of_robot) {
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot));
    worlds.insert(world);
  }
  for (const std::string& world : worlds) {
    worlds_.push_back(std::make_unique<WorldLink>(participant, world));
  }
}

TeleoperatorTopics::~TeleoperatorTopics() = default;

void TeleoperatorTopics::TakeIn() {
  for (const auto& world : worlds_) {
    for (const Belief& belief : world->belief.TakeValid(kToDomain)) person_.Receive(belief);
    for (const MapUpdate& map : world->belief_map.TakeValid(kToDomain)) {
      person_.ReceiveCellSize(world->name, map.cell_size_m);
    }
  }
  for (const auto& robot : robots_) {
    for (const RobotState& state : robot->state.TakeValid(kToDomain)) person_.Receive(state);
    for (const Snapshot& picture : robot->snapshot.TakeValid(kToDomain)) person_.Receive(picture);
  }
}

void TeleoperatorTopics::Step() {
  TakeIn();
  AskThrough(client_, person_, clock_);
}

namespace {

using namespace std::chrono_literals;

}  // namespace

struct SimulatedOperatorService::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name)
      : state(participant, bus::kRobotState, name),
        snapshot(participant, bus::kSnapshot, name),
        attention(participant, bus::kAttention, name),
        guidance(participant, bus::kGuidance, name),
        stop(participant, bus::kStopOrder, name) {}

  bus::Subscriber<conav_msgs::msg::RobotState> state;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot;
  bus::Subscriber<conav_msgs::msg::AttentionRequest> attention;
  bus::Subscriber<conav_msgs::msg::Guidance> guidance;
  bus::Subscriber<conav_msgs::msg::StopOrder> stop;
  bool stopped = false;
};

SimulatedOperatorService::SimulatedOperatorService(bus::Participant& participant,
                                                   const SimulatedOperatorConfig& config,
                                                   const Clock& clock)
    : participant_(participant),
      clock_(clock),
      person_(config.person, config.seed, WorldOfRobot("simulated_operator", config.robots)),
      client_(participant, clock,
              {UniqueClientName(config.client), 0.25, config.request_deadline_s}),
      diagnostics_(participant, clock) {
  if (config.interaction == "teleoperation") {
    teleoperator_ = std::make_unique<TeleoperatorTopics>(
        participant, clock, client_, config.person, config.seed,
        WorldOfRobot("simulated_operator", config.robots));
    return;
  }
  std::set<std::string> worlds;
  for (const auto& [robot, world] : WorldOfRobot("simulated_operator", config.robots)) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot));
    worlds.insert(world);
  }
  for (const std::string& world : worlds) {
    beliefs_.push_back(std::make_unique<bus::Subscriber<conav_msgs::msg::BeliefMap>>(
        participant, bus::kBelief, world));
  }
  if (config.person.order == "queue") {
    queue_.emplace(participant, bus::kAttentionQueue);
    clock_topic_.emplace(participant, bus::kClock);
  }
}

SimulatedOperatorService::~SimulatedOperatorService() = default;

void SimulatedOperatorService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    // Thinking and pauses end without a message.
    const bool busy = teleoperator_ ? teleoperator_->person().open() > 0 : person_.open() > 0;
    participant_.Wait(busy ? 10ms : 100ms);
    Step();
  }
}

void SimulatedOperatorService::Step() {
  if (teleoperator_) {
    teleoperator_->Step();
    return diagnostics_.Tick([this] { return ReportTeleoperation(); });
  }
  TakeIn();
  const bool all_stopped =
      std::ranges::all_of(robots_, [](const auto& robot) { return robot->stopped; });
  if (!all_stopped) AskThrough(client_, person_, clock_);
  diagnostics_.Tick([this] { return Report(); });
}

void SimulatedOperatorService::TakeIn() {
  const auto now = clock_.Now();
  for (const auto& world : beliefs_) {
    for (const Belief& belief : world->TakeValid(kToDomain)) person_.Receive(belief);
  }
  for (const auto& robot : robots_) {
    for (const Guidance& guidance : robot->guidance.TakeValid(kToDomain)) person_.Receive(guidance);
    for (const StopOrder& stop : robot->stop.TakeValid(kToDomain)) robot->stopped = stop.stopped;
    for (const RobotState& state : robot->state.TakeValid(kToDomain)) {
      person_.Receive(state);
      person_.Receive(state.stamp);
    }
    for (const Snapshot& picture : robot->snapshot.TakeValid(kToDomain))
      person_.Receive(picture, now);
    for (const auto& request : robot->attention.TakeValid(kToDomain)) person_.Receive(request, now);
  }
  if (!queue_) return;
  for (const auto& message : clock_topic_->Take()) {
    if (const auto time = ToDomain(message.clock())) person_.Receive(*time);
  }
  for (const AttentionQueueState& queue : queue_->TakeValid(kToDomain)) person_.Receive(queue);
}

Health SimulatedOperatorService::Report() const {
  const SyntheticOperator::Counts& counts = person_.counts();
  Health health{Health::Level::kOk, "synthetic person at work", {}};
  if (counts.given_up > 0) {
    health.level = Health::Level::kWarning;
    health.message = "gave up on a request: " + counts.newest_problem;
  }
  health.values = {{"open_items", std::to_string(person_.open())},
                   {"pictures", std::to_string(counts.pictures)},
                   {"edited_cells", std::to_string(counts.edits)},
                   {"given_guidance", std::to_string(counts.guidance)},
                   {"refused_requests", std::to_string(counts.refused)}};
  return health;
}

Health SimulatedOperatorService::ReportTeleoperation() const {
  const SyntheticTeleoperator::Counts& counts = teleoperator_->person().counts();
  Health health{Health::Level::kOk, "synthetic person steers by keys", {}};
  health.values = {{"robots_with_goals_left", std::to_string(teleoperator_->person().open())},
                   {"keys", std::to_string(counts.keys)},
                   {"bumps", std::to_string(counts.bumps)},
                   {"meetings", std::to_string(counts.meetings)},
                   {"edited_cells", std::to_string(counts.edits)},
                   {"refused_requests", std::to_string(counts.refused)}};
  return health;
}

}  // namespace conav::operators
