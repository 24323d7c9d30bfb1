#include "operator/console/participant_task.h"

#include <fmt/format.h>

namespace conav::operators {
namespace {

template <class A, class B>
bool SameShape(const Grid<A>& a, const Grid<B>& b) {
  return a.rows() == b.rows() && a.columns() == b.columns();
}

bool WorksOnTheMap(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body);
}

bool CommandsARobot(const OperatorRequest& request) {
  return std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<DriveRequest>(request.body);
}

}  // namespace

void ParticipantTask::Receive(const RobotState& state) {
  if (!robots_.contains(state.robot)) return;
  reported_[state.robot] = {static_cast<std::uint32_t>(state.goals_left.size()), state.goals_total,
                            state.snapshots};
}

void ParticipantTask::Begin() {
  if (phase_ == TaskPhase::kWaiting) phase_ = TaskPhase::kRunning;
}

std::uint32_t ParticipantTask::goals_left() const {
  std::uint32_t left = 0;
  for (const auto& [name, robot] : reported_) left += robot.goals_left;
  return left;
}

std::string ParticipantTask::CheckAllowed(const OperatorRequest& request) const {
  const bool commands = CommandsARobot(request);
  if (commands && kind_ == TaskKind::kMapping) {
    return "in the mapping task the robot finds its own way: answer its picture instead";
  }
  const bool is_over = phase_ == TaskPhase::kFinished;
  return is_over && (commands || WorksOnTheMap(request)) ? "this maze is finished" : "";
}

std::string ParticipantTask::CheckFinish() const {
  if (phase_ == TaskPhase::kFinished) return "this maze is finished";
  if (phase_ == TaskPhase::kWaiting) return "this maze has not begun yet: resume the robot first";
  if (reported_.size() < robots_.size()) return "the robot has not reported yet";
  if (const std::uint32_t left = goals_left(); left > 0) {
    return fmt::format("the robot has {} more {} to reach", left, left == 1 ? "goal" : "goals");
  }
  return truth_ ? "" : "the true maze is not known yet: try again in a moment";
}

Result<TaskResult> ParticipantTask::Measure(const Belief& belief, const BeliefGrid& initial) const {
  if (std::string why = CheckFinish(); !why.empty()) return Fail(ErrorCode::kRefused, why);
  if (!SameShape(*truth_, belief.wall_probability) || !SameShape(*truth_, initial)) {
    return Fail(ErrorCode::kRefused, "the true maze has another size than the map");
  }
  const OccupancyGrid before = ToOccupancy(initial);
  const MapAccuracy now = CompareMaps(*truth_, before, belief.wall_probability);
  TaskResult result;
  result.mapping_accuracy = now.mapping;
  result.cell_accuracy = now.cell;
  result.initial_cell_accuracy = CompareMaps(*truth_, before, initial).cell;
  result.wrong_at_first = now.wrong_at_first;
  result.corrected = now.corrected;
  result.broken = now.broken;
  result.edits = belief.revision;
  for (const auto& [name, robot] : reported_) {
    result.images += robot.images;
    result.goals += robot.goals;
  }
  return result;
}

}  // namespace conav::operators
