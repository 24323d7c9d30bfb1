#include "operator/console/task_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "common/service/robot_list.h"

namespace conav::operators {
namespace {

constexpr const char* kResultKey = "operator.task.result: ";

std::string OnlyWorld(const OperatorConfig& config) {
  const auto world_of_robot = WorldOfRobot("operator", config.robots);
  const std::string& first = world_of_robot.begin()->second;
  for (const auto& [robot, world] : world_of_robot) {
    if (world == first) continue;
    throw StartupError(fmt::format(
        "operator.task: all robots have to be in one world, not in {} and {}", first, world));
  }
  return first;
}

std::set<std::string> Robots(const OperatorConfig& config) {
  std::set<std::string> robots;
  for (const auto& [robot, world] : WorldOfRobot("operator", config.robots)) robots.insert(robot);
  return robots;
}

/// Of a service that was restarted after the participant had finished.
std::optional<TaskResult> ReadResult(const std::string& file) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (!text) throw StartupError(kResultKey + text.error().text);
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  TaskResult result;
  try {
    json.at("mapping_accuracy").get_to(result.mapping_accuracy);
    json.at("cell_accuracy").get_to(result.cell_accuracy);
  } catch (const nlohmann::json::exception&) {
    throw StartupError(kResultKey + file + " is no result of a mapping task");
  }
  return result;
}

/// Better known now than when the participant is done.
void EnsureWritable(const std::string& file) {
  if (const auto writable = CheckWritable(file); !writable) {
    throw StartupError(kResultKey + writable.error().text);
  }
}

}  // namespace

TaskTopics::TaskTopics(bus::Participant& participant, const OperatorConfig& config,
                       BeliefStore& store, const Clock& clock)
    : options_(config.task),
      world_(OnlyWorld(config)),
      store_(store),
      clock_(clock),
      truth_(participant, bus::kTruth, world_),
      task_(Robots(config), config.task.kind == "study" ? TaskKind::kStudy : TaskKind::kMapping) {
  if (const auto before = ReadResult(options_.result)) {
    Adopt(*before);
  } else {
    EnsureWritable(options_.result);
  }
}

void TaskTopics::Step() {
  for (const MapUpdate& truth : truth_.TakeValid(kToDomain)) task_.Receive(truth.cells);
}

void TaskTopics::Receive(const ControlRegistry& control) {
  if (task_.phase() != TaskPhase::kWaiting) return;
  const auto goes = [](const auto& robot) { return !robot.second.stop.stopped; };
  if (!std::ranges::any_of(control.robots(), goes)) return;
  task_.Begin();
  began_ = clock_.Now();
  began_at_s_ = WallSeconds();
}

BeliefStore::Answer TaskTopics::Finish(const OperatorRequest& request) {
  if (auto repeat = store_.FindRepeat(request)) return *std::move(repeat);
  const auto result = Measure();
  const auto written =
      result ? WriteResult(*result) : Result<void>(tl::unexpected<Error>(result.error()));
  if (!written) return {Refusal(request, written.error().text)};
  Adopt(*result);
  return store_.Keep(request, {});
}

Result<TaskResult> TaskTopics::Measure() {
  const Belief* belief = store_.FindBelief(world_);
  if (belief == nullptr) return Fail(ErrorCode::kRefused, "the map is not known yet");
  return store_.InitialMap(world_).and_then(
      [&](const std::optional<BeliefGrid>& initial) -> Result<TaskResult> {
        return task_.Measure(*belief, initial.value_or(belief->wall_probability));
      });
}

Result<void> TaskTopics::WriteResult(const TaskResult& result) {
  const std::chrono::duration<double> taken = clock_.Now() - began_;
  nlohmann::ordered_json json;
  json["participant"] = options_.participant;
  json["number"] = options_.number;
  json["mapping_accuracy"] = result.mapping_accuracy;
  json["cell_accuracy"] = result.cell_accuracy;
  json["initial_cell_accuracy"] = result.initial_cell_accuracy;
  json["wrong_at_first"] = result.wrong_at_first;
  json["corrected"] = result.corrected;
  json["broken"] = result.broken;
  json["edits"] = result.edits;
  json["pictures"] = result.pictures;
  json["goals"] = result.goals;
  json["began_at"] = began_at_s_;
  json["finished_at"] = WallSeconds();
  json["duration_s"] = taken.count();
  return WriteJsonFile(options_.result, json);
}

void TaskTopics::Adopt(const TaskResult& result) {
  result_ = result;
  task_.Finish();
}

TaskStatus TaskTopics::status() const {
  return {.participant = options_.participant,
          .number = options_.number,
          .count = options_.count,
          .earlier = options_.earlier,
          .phase = task_.phase(),
          .goals_left = task_.goals_left(),
          .may_finish = task_.CheckFinish().empty(),
          .mapping_accuracy = result_.mapping_accuracy,
          .cell_accuracy = result_.cell_accuracy};
}

}  // namespace conav::operators
