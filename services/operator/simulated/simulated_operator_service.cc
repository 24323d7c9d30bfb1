#include "operator/simulated/simulated_operator_service.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/service/robot_list.h"
#include "common/service/robot_state_topics.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

/// Passes replies to a synthetic person, and sends its next request if it may ask.
/// Does not block.
template <class Person>
void AskThrough(OperatorClient& client, Person& person, const Clock& clock, bool may_ask) {
  for (const OperatorClient::Outcome& outcome : client.Poll()) {
    if (!outcome.reply) {
      LOG_WARNING("no reply", "reason", outcome.reply.error().text);
    } else if (!outcome.reply->accepted) {
      LOG_WARNING("refused", "id", outcome.request_id, "reason", outcome.reply->reason);
    }
    person.Answered(outcome.reply, clock.Now());
  }
  if (!may_ask) return;
  if (const auto ask = person.Next(clock.Now())) {
    client.Send(ask->world, ask->body, ask->stamp);
  }
}

/// One that does not keep its goals may be given more.
bool HasAllItsGoals(const RobotState& state) {
  return state.goals_stamp != SimTime{} && state.goals_total > 0 && state.goals_left.empty();
}

}  // namespace

struct SimulatedOperatorService::WorldLink {
  WorldLink(bus::Participant& participant, const std::string& name, bool steers, bool marks_goals)
      : name(name), belief(participant, bus::kBelief, bus::kBeliefChanges, name) {
    if (steers) belief_map.emplace(participant, bus::kBeliefMap, name);
    if (marks_goals) goals.emplace(participant, bus::kGoals, name);
  }

  std::string name;
  bus::ChangesSubscriber<conav_msgs::msg::BeliefMap> belief;
  std::optional<bus::Subscriber<nav_msgs::msg::OccupancyGrid>> belief_map;  // of a teleoperator
  std::optional<bus::Subscriber<visualization_msgs::msg::MarkerArray>> goals;
};

struct SimulatedOperatorService::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, bool steers)
      : state(participant, name), snapshot(participant, bus::kSnapshot, name) {
    if (!steers) asks.emplace(participant, name);
  }
  /// What one who steers by keys does not look at.
  struct Asks {
    Asks(bus::Participant& participant, const std::string& name)
        : attention(participant, bus::kAttention, name),
          guidance(participant, bus::kGuidance, name),
          stop(participant, bus::kStopOrder, name) {}

    bus::Subscriber<conav_msgs::msg::AttentionRequest> attention;
    bus::Subscriber<conav_msgs::msg::Guidance> guidance;
    bus::Subscriber<conav_msgs::msg::StopOrder> stop;
    bool stopped = false;
  };

  RobotStateTopics state;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot;
  std::optional<Asks> asks;
  bool is_done = false;  // it has reached all its goals
};

SimulatedOperatorService::SimulatedOperatorService(bus::Participant& participant,
                                                   const SimulatedOperatorConfig& config,
                                                   const Clock& clock)
    : participant_(participant),
      clock_(clock),
      person_(config.person, config.seed, WorldOfRobot("simulated_operator", config.robots)),
      client_(participant, clock,
              {config.client + "-" + UniqueId(), 0.25, config.request_deadline_s}),
      name_(config.client),
      diagnostics_(participant, clock) {
  const auto world_of_robot = WorldOfRobot("simulated_operator", config.robots);
  const bool steers = config.interaction == "teleoperation";
  if (steers) teleoperator_.emplace(config.person, config.seed, world_of_robot);
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot, steers));
    if (!worlds.insert(world).second) continue;
    worlds_.push_back(
        std::make_unique<WorldLink>(participant, world, steers, config.person.marks_goals));
  }
  if (!steers && config.person.order == "queue") {
    queue_.emplace(participant, bus::kAttentionQueue);
    clock_topic_.emplace(participant, bus::Sparse(bus::kClock));
  }
}

SimulatedOperatorService::~SimulatedOperatorService() = default;

void SimulatedOperatorService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    // Thinking and pauses end without a message.
    const bool busy = teleoperator_ ? teleoperator_->open() > 0 : person_.open() > 0;
    participant_.Wait(busy ? 10ms : 100ms);
    Step();
  }
}

void SimulatedOperatorService::Step() {
  TakeIn();
  const bool may_ask = !stands_aside_ && !AllGoalsReached();
  if (teleoperator_) {
    AskThrough(client_, *teleoperator_, clock_, may_ask);
    return diagnostics_.Tick([this] { return ReportTeleoperation(); });
  }
  AskThrough(client_, person_, clock_, may_ask && !AllStopped());
  diagnostics_.Tick([this] { return Report(); });
}

bool SimulatedOperatorService::AllStopped() const {
  return std::ranges::all_of(robots_, [](const auto& robot) { return robot->asks->stopped; });
}

bool SimulatedOperatorService::AllGoalsReached() const {
  return std::ranges::all_of(robots_, [](const auto& robot) { return robot->is_done; });
}

void SimulatedOperatorService::StandAsideFor(const std::string& author) {
  if (stands_aside_ || author.empty() || author.starts_with(name_ + "-")) return;
  stands_aside_ = true;
  LOG_INFO("somebody else guides the robots: the simulated operator stands aside", "client",
           author);
}

void SimulatedOperatorService::TakeIn() {
  const auto now = clock_.Now();
  const auto pass = [this](const auto& value) {
    teleoperator_ ? teleoperator_->Receive(value) : person_.Receive(value);
  };
  for (const auto& world : worlds_) {
    for (const Belief& belief : world->belief.TakeValid(kToDomain)) {
      StandAsideFor(belief.edited_by);
      pass(belief);
    }
    if (world->goals) TakeInGoals(*world);
    if (!world->belief_map) continue;
    for (const MapUpdate& map : world->belief_map->TakeValid(kToDomain)) {
      teleoperator_->ReceiveCellSize(world->name, map.cell_size_m);
    }
  }
  for (const auto& robot : robots_) {
    auto& asks = robot->asks;
    if (asks) {
      for (const Guidance& guidance : asks->guidance.TakeValid(kToDomain)) {
        StandAsideFor(guidance.given_by);
        person_.Receive(guidance);
      }
      for (const StopOrder& stop : asks->stop.TakeValid(kToDomain)) asks->stopped = stop.stopped;
    }
    for (const auto& state : robot->state.TakeStamped()) {
      robot->is_done = HasAllItsGoals(state.value);
      pass(state.value);
      person_.Receive(state.value.stamp);
    }
    for (const Snapshot& snapshot : robot->snapshot.TakeValid(kToDomain)) {
      if (stands_aside_) continue;  // nothing is done about them any longer
      teleoperator_ ? teleoperator_->Receive(snapshot) : person_.Receive(snapshot, now);
    }
    if (!asks) continue;
    for (const auto& request : asks->attention.TakeValid(kToDomain)) {
      if (!stands_aside_) person_.Receive(request, now);
    }
  }
  if (queue_) TakeInQueue();
}

void SimulatedOperatorService::TakeInGoals(WorldLink& world) {
  constexpr std::int32_t kAdd = 0;  // visualization_msgs/Marker
  for (const auto& message : world.goals->Take()) {
    std::map<std::string, std::vector<Position>> objects;  // by robot
    for (const auto& marker : message.markers()) {
      const Position place{marker.pose().position().x(), marker.pose().position().y()};
      if (marker.action() != kAdd || !std::isfinite(place.x_m) || !std::isfinite(place.y_m)) {
        continue;
      }
      objects[marker.ns()].push_back(place);  // the name space is the robot's name
    }
    for (auto& [robot, places] : objects) person_.ReceiveGoalObjects(robot, std::move(places));
  }
}

void SimulatedOperatorService::TakeInQueue() {
  for (const auto& message : clock_topic_->Take()) {
    if (const auto time = ToDomain(message.clock())) person_.Receive(*time);
  }
  for (const AttentionQueueState& queue : queue_->TakeValid(kToDomain)) person_.Receive(queue);
}

Health SimulatedOperatorService::Report() const {
  const SyntheticOperator::Counts& counts = person_.counts();
  Health health{Health::Level::kOk,
                stands_aside_ ? "stands aside: somebody else guides" : "synthetic person at work",
                {}};
  if (counts.given_up > 0) {
    health.level = Health::Level::kWarning;
    health.message = "gave up on a request: " + counts.newest_problem;
  }
  health.values = {{"open_items", std::to_string(person_.open())},
                   {"pictures", std::to_string(counts.snapshots)},
                   {"edited_cells", std::to_string(counts.edits)},
                   {"given_guidance", std::to_string(counts.guidance)},
                   {"refused_requests", std::to_string(counts.refused)}};
  return health;
}

Health SimulatedOperatorService::ReportTeleoperation() const {
  const SyntheticTeleoperator::Counts& counts = teleoperator_->counts();
  Health health{Health::Level::kOk, "synthetic person steers by keys", {}};
  health.values = {{"robots_with_goals_left", std::to_string(teleoperator_->open())},
                   {"keys", std::to_string(counts.keys)},
                   {"bumps", std::to_string(counts.bumps)},
                   {"meetings", std::to_string(counts.meetings)},
                   {"edited_cells", std::to_string(counts.edits)},
                   {"refused_requests", std::to_string(counts.refused)}};
  return health;
}

}  // namespace conav::operators
