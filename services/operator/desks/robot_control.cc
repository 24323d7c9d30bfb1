#include "operator/desks/robot_control.h"

#include <utility>

#include "common/bus/send.h"
#include "common/protocol/convert.h"
#include "common/service/robot_list.h"

namespace conav::operators {

RobotControl::RobotControl(bus::Participant& participant, const OperatorConfig& config,
                           BeliefStore& store, const Clock& clock)
    : store_(store), clock_(clock), desk_(WorldOfRobot("operator", config.robots), config.control) {
  for (const auto& [robot, hold] : store.holds()) desk_.Adopt(hold);
  for (const auto& [name, robot] : desk_.robots()) {
    holds_[name] = std::make_unique<HoldPublisher>(participant, bus::kHoldOrder, name);
    if (robot.hold.revision > 0) Publish(robot.hold);
  }
}

bool RobotControl::Handles(const OperatorRequest& request) {
  return std::holds_alternative<StopRequest>(request.body) ||
         std::holds_alternative<GoRequest>(request.body) ||
         std::holds_alternative<TakeControlRequest>(request.body) ||
         std::holds_alternative<ReleaseControlRequest>(request.body);
}

Result<std::vector<HoldOrder>> RobotControl::Decide(const OperatorRequest& request, SimTime now,
                                                    ControlDesk& desk) const {
  if (const auto* stop = std::get_if<StopRequest>(&request.body)) {
    return desk.Stop(request.client, *stop, now);
  }
  if (const auto* go = std::get_if<GoRequest>(&request.body)) {
    return desk.Go(request.client, *go, now);
  }
  const auto none = [] { return std::vector<HoldOrder>{}; };
  if (const auto* take = std::get_if<TakeControlRequest>(&request.body)) {
    return desk.Take(request.client, *take, clock_.Now()).map(none);
  }
  return desk.Release(request.client, std::get<ReleaseControlRequest>(request.body)).map(none);
}

BeliefStore::Answer RobotControl::Answer(const OperatorRequest& request, SimTime now) {
  ControlDesk decided = desk_;  // counts only when it is stored
  const auto orders = Decide(request, now, decided);
  if (!orders) return {{request.client, request.request_id, false, orders.error().text, 0}};
  BeliefStore::Answer answer = store_.Keep(request, *orders);
  if (!answer.changed) return answer;
  desk_ = std::move(decided);
  for (const HoldOrder& order : *orders) {
    desk_.Adopt(order);
    Publish(order);
  }
  return answer;
}

std::string RobotControl::WhyNot(const OperatorRequest& request) const {
  const Clock::TimePoint now = clock_.Now();
  if (std::holds_alternative<EditRequest>(request.body)) {
    return desk_.WhyNotEdit(request.client, request.world, now);
  }
  if (const auto* guide = std::get_if<GuideRequest>(&request.body)) {
    return desk_.WhyNotCommand(request.client, guide->robot, now);
  }
  if (const auto* answer = std::get_if<AnswerRequest>(&request.body)) {
    return desk_.WhyNotCommand(request.client, answer->robot, now);
  }
  const auto* drive = std::get_if<DriveRequest>(&request.body);
  if (drive == nullptr || drive->drive == DriveAction::kStop) return "";
  const auto found = desk_.robots().find(drive->robot);
  if (found != desk_.robots().end() && found->second.hold.stopped) {
    return drive->robot + " is stopped: let it go first";
  }
  return desk_.WhyNotCommand(request.client, drive->robot, now);
}

void RobotControl::Publish(const HoldOrder& order) {
  bus::Send(*holds_.at(order.robot), ToMessage(order));
}

}  // namespace conav::operators
