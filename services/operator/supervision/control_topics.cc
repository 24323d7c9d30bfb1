#include "operator/supervision/control_topics.h"

#include <utility>

#include "common/msg/convert.h"
#include "common/service/robot_list.h"

namespace conav::operators {

ControlTopics::ControlTopics(bus::Participant& participant, const OperatorConfig& config,
                             BeliefStore& store, const Clock& clock)
    : store_(store),
      clock_(clock),
      registry_(WorldOfRobot("operator", config.robots), config.control) {
  for (const auto& [robot, stop] : store.stops()) registry_.Adopt(stop);
  for (const auto& [name, robot] : registry_.robots()) {
    stops_[name] = std::make_unique<StopPublisher>(participant, bus::kStopOrder, name);
    if (robot.stop.revision > 0) Publish(robot.stop);
  }
}

bool ControlTopics::Handles(const OperatorRequest& request) {
  return std::holds_alternative<StopRequest>(request.body) ||
         std::holds_alternative<GoRequest>(request.body) ||
         std::holds_alternative<TakeControlRequest>(request.body) ||
         std::holds_alternative<ReleaseControlRequest>(request.body);
}

Result<std::vector<StopOrder>> ControlTopics::Decide(const OperatorRequest& request, SimTime now,
                                                     ControlRegistry& registry) const {
  if (const auto* stop = std::get_if<StopRequest>(&request.body)) {
    return registry.Stop(request.client, *stop, now);
  }
  if (const auto* go = std::get_if<GoRequest>(&request.body)) {
    return registry.Go(request.client, *go, now);
  }
  const auto none = [] { return std::vector<StopOrder>{}; };
  if (const auto* take = std::get_if<TakeControlRequest>(&request.body)) {
    return registry.Take(request.client, *take, clock_.Now()).map(none);
  }
  return registry.Release(request.client, std::get<ReleaseControlRequest>(request.body)).map(none);
}

BeliefStore::Answer ControlTopics::Answer(const OperatorRequest& request, SimTime now) {
  ControlRegistry decided = registry_;  // counts only when it is stored
  const auto orders = Decide(request, now, decided);
  if (!orders) return {Refusal(request, orders.error().text)};
  BeliefStore::Answer answer = store_.Keep(request, *orders);
  if (!answer.changed) return answer;
  registry_ = std::move(decided);
  for (const StopOrder& order : *orders) {
    registry_.Adopt(order);
    Publish(order);
  }
  return answer;
}

std::string ControlTopics::CheckAllowed(const OperatorRequest& request) const {
  const Clock::TimePoint now = clock_.Now();
  if (std::holds_alternative<EditRequest>(request.body)) {
    return registry_.CheckEdit(request.client, request.world, now);
  }
  if (const auto* guide = std::get_if<GuideRequest>(&request.body)) {
    return registry_.CheckCommand(request.client, guide->robot, now);
  }
  if (const auto* answer = std::get_if<AnswerRequest>(&request.body)) {
    return registry_.CheckCommand(request.client, answer->robot, now);
  }
  const auto* drive = std::get_if<DriveRequest>(&request.body);
  if (drive == nullptr || drive->drive == DriveAction::kStop) return "";
  const auto found = registry_.robots().find(drive->robot);
  if (found != registry_.robots().end() && found->second.stop.stopped) {
    return drive->robot + " is stopped: resume it first";
  }
  return registry_.CheckCommand(request.client, drive->robot, now);
}

void ControlTopics::Publish(const StopOrder& order) {
  bus::Send(*stops_.at(order.robot), ToMessage(order));
}

}  // namespace conav::operators
