#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav::operators {

/// Section `operator.task:`, for those who let people take part in something
/// (docs/mapping-task.md). All robots are then in one world.
struct TaskOptions {
  /// "mapping" = one maze of the mapping task; "study" = one maze with the method of the planners;
  /// empty = none, robots are supervised.
  std::string kind;
  std::string participant;  // a pseudonym, UTF-8 without slashes and control characters
  int number = 1;           // which of the mazes or parts, for the page
  int count = 1;            // of mazes or parts
  /// Mapping accuracies of the mazes before, 0 to 1, for the page.
  std::vector<double> earlier;
  /// JSON file that the result is written to when the maze is finished; with one of a maze that was
  /// finished before, the service takes it as finished.
  std::string result;

  bool on() const { return !kind.empty(); }
  void Visit(ConfigReader& reader) {
    reader.Choice("kind", kind, {"", "mapping", "study"});
    reader.Field("participant", participant);
    if (!IsPlainName(participant)) reader.Refuse("participant", kNoPlainName);
    reader.Field("number", number, 1, 1000);
    reader.Field("count", count, 1, 1000);
    if (number > count) reader.Refuse("number", "is above count");
    reader.Field("earlier", earlier);
    const auto is_share = [](double accuracy) { return accuracy >= 0.0 && accuracy <= 1.0; };
    if (!std::ranges::all_of(earlier, is_share)) {
      reader.Refuse("earlier", "has a value that is out of range [0, 1]");
    }
    reader.Field("result", result);
    if (on() && result.empty()) reader.Refuse("result", "names no file");
  }
};

enum class TaskKind {
  kMapping,  // the robot finds its own way
  kStudy,    // the participant guides or drives it, as the method says
};

enum class TaskPhase {
  kWaiting,  // the robots are stopped until the participant resumes one
  kRunning,
  kFinished,  // the map stays as it is
};

/// What a page shows.
struct TaskStatus {
  std::string participant;
  int number = 1;               // of the maze
  int count = 1;                // of mazes
  std::vector<double> earlier;  // mapping accuracies of the mazes before
  TaskPhase phase = TaskPhase::kWaiting;
  std::uint32_t goals_left = 0;
  bool may_finish = false;
  double mapping_accuracy = 0.0;  // once it is finished
  bool operator==(const TaskStatus&) const = default;
};

/// How the participant did.
struct TaskResult {
  double mapping_accuracy = 0.0;
  double cell_accuracy = 0.0;
  double initial_cell_accuracy = 0.0;
  int wrong_at_first = 0;   // cells of the map
  int corrected = 0;        // of these
  int broken = 0;           // cells that were right at first
  std::uint64_t edits = 0;  // requests that changed the map
  std::uint64_t images = 0;
  std::uint32_t goals = 0;
  bool operator==(const TaskResult&) const = default;
};

/// One maze of the mapping task (paper, Appendix A), or of a study, as the participant goes through
/// it: begins when a robot is resumed, may be finished as soon as the robots have reached all
/// goals, and then the map stays as it is. Pure; threads: not synchronised.
class ParticipantTask {
 public:
  /// `robots`: those of the maze.
  explicit ParticipantTask(std::set<std::string> robots, TaskKind kind = TaskKind::kMapping)
      : robots_(std::move(robots)), kind_(kind) {}

  void Receive(const RobotState& state);
  /// The true maze.
  void Receive(const OccupancyGrid& truth) { truth_ = truth; }
  /// A robot was resumed; ignored after the first time.
  void Begin();

  TaskPhase phase() const { return phase_; }
  std::uint32_t goals_left() const;

  /// Why the task forbids `request`; empty = it does not.
  std::string CheckAllowed(const OperatorRequest& request) const;
  /// Why the participant may not finish; empty = they may.
  std::string CheckFinish() const;
  /// What it would be with the map as it is now, which was `initial` at first. Errors: kRefused
  /// with CheckFinish(), or when the maps do not belong together.
  [[nodiscard]] Result<TaskResult> Measure(const Belief& belief, const BeliefGrid& initial) const;
  void Finish() { phase_ = TaskPhase::kFinished; }

 private:
  struct Robot {
    std::uint32_t goals_left = 0;
    std::uint32_t goals = 0;
    std::uint64_t images = 0;
  };

  std::set<std::string> robots_;
  TaskKind kind_;
  std::map<std::string, Robot> reported_;
  std::optional<OccupancyGrid> truth_;
  TaskPhase phase_ = TaskPhase::kWaiting;
};

}  // namespace conav::operators
