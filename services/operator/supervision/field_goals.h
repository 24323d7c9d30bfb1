#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "operator/belief/database.h"

namespace conav::operators {

/// Section `operator.goals:`.
struct GoalOptions {
  /// Robots whose goals this service keeps and publishes: those that do not keep them themselves, as
  /// the simulator's do. Names, without the world.
  std::vector<std::string> robots;
  /// A goal is reached when the robot is this near, or arrives in the goal's cell of its map.
  double tolerance_m = 0.5;
  /// YAML file with the goals to begin with (ReadMission()); none = operators give them.
  std::string mission;
  /// So many goals of each robot are there to be found, and given once somebody has recognised them;
  /// 0 = there are those that are given. RobotGoals::total is at least this; goals that were given
  /// wrongly fill it as well.
  int to_find = 0;

  void Visit(ConfigReader& reader) {
    reader.Field("robots", robots);
    reader.Field("tolerance_m", tolerance_m, 0.0, 100.0);
    reader.Field("mission", mission);
    reader.Field("to_find", to_find, 0, 1000);
  }
};

/// Goals by robot, in the order of the file.
using Mission = std::map<std::string, std::vector<Position>>;

/// Reads a file of lines "r1: [[x, y], ...]", metres in the frame "map". Errors: those of ReadFile;
/// kMalformed names file and line: no such form, a robot that is not one of `robots` or comes twice, a
/// place that is no number or more than 1000 km away.
[[nodiscard]] Result<Mission> ReadMission(const std::filesystem::path& file,
                                          const std::vector<std::string>& robots);

/// The goals of robots that do not keep them: given by a mission, by operators, or by a goal pose, in
/// any order of visit, at most one in a cell of the robot's map.
///
/// A robot's goals are known to others from its first report on. Stamps rise with each change, and
/// are not older than the report behind it. A robot that keeps its goals itself has none here.
/// Pure; threads: not synchronised.
class FieldGoals {
 public:
  static constexpr std::size_t kMostGoals = 1000;  // left, of one robot

  /// `world_of_robot`: the robots whose goals are kept here. `stored`: what was stored of them; it
  /// counts unless `mission` is another one than then.
  FieldGoals(const std::map<std::string, std::string>& world_of_robot, const GoalOptions& options,
             const Mission& mission, const std::map<std::string, KeptGoals>& stored);

  struct Robot {
    KeptGoals kept;
    std::optional<RobotState> state;  // the newest report
    bool keeps_goals = false;         // the robot itself
    std::string outside;              // which goals its map does not hold, for people; empty = none
  };

  /// A report of the robot. The goals, where it changes them or is the first.
  std::optional<KeptGoals> Receive(const RobotState& state);

  /// What the goals will be; they count once they are adopted. Errors: kRefused (the robot's goals are
  /// not kept here, or by itself; it has not reported; outside of its map; too many), kNotFound (no
  /// such goal to remove, and none to add).
  [[nodiscard]] Result<KeptGoals> Change(const GoalsRequest& request) const;
  void Adopt(const KeptGoals& kept);

  const std::map<std::string, Robot>& robots() const { return robots_; }

 private:
  /// A stamp after the goals' own, not before the newest report.
  static SimTime NextStamp(const Robot& robot);
  /// Takes out goals that the robot's map does not hold.
  static bool DropOutside(Robot& robot);
  std::uint32_t TotalOf(const RobotGoals& goals) const;

  std::size_t to_find_;
  std::map<std::string, Robot> robots_;
};

}  // namespace conav::operators
