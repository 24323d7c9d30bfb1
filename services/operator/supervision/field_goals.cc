#include "operator/supervision/field_goals.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace conav::operators {
namespace {

constexpr double kFarthest = 1.0e6;  // m

std::string Describe(Position place) {
  return fmt::format("({:.6g}, {:.6g})", place.x_m, place.y_m);
}

/// Reads one mission; throws YAML::Exception, which knows the line.
struct MissionReader {
  const std::vector<std::string>& robots;

  [[noreturn]] static void Refuse(const YAML::Node& node, const std::string& text) {
    throw YAML::Exception(node.Mark(), text);
  }
  static double Metres(const YAML::Node& node) {
    double value = NAN;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      Refuse(node, fmt::format("'{}' is no number of metres", YAML::Dump(node)));
    }
    if (std::abs(value) > kFarthest) {
      Refuse(node, fmt::format("{} m is farther than {} m", value, kFarthest));
    }
    return value;
  }
  static std::vector<Position> Places(const YAML::Node& list, const std::string& robot) {
    if (!list.IsSequence()) Refuse(list, "the goals of " + robot + " are no list of [x, y]");
    std::vector<Position> places;
    for (const YAML::Node& place : list) {
      if (!place.IsSequence() || place.size() != 2) {
        Refuse(place, fmt::format("'{}' of {} is no [x, y]", YAML::Dump(place), robot));
      }
      places.push_back({Metres(place[0]), Metres(place[1])});
    }
    return places;
  }
  Mission Read(const YAML::Node& document) const {
    Mission mission;
    if (document.IsNull()) return mission;
    if (!document.IsMap()) Refuse(document, "a mission is lines of \"robot: [[x, y], ...]\"");
    for (const auto& entry : document) {
      const auto robot = entry.first.as<std::string>();
      if (std::ranges::find(robots, robot) == robots.end()) {
        Refuse(entry.first, fmt::format("robot '{}' is not in operator.goals.robots", robot));
      }
      if (mission.contains(robot))
        Refuse(entry.first, fmt::format("robot '{}' comes twice", robot));
      mission[robot] = Places(entry.second, robot);
    }
    return mission;
  }
};

/// The same text for the same goals, to tell missions apart.
std::string TextOf(const std::vector<Position>& places) {
  std::string text;
  for (const Position place : places) text += fmt::format("{} {}\n", place.x_m, place.y_m);
  return text;
}

tl::unexpected<Error> Refused(std::string text) {
  return Fail(ErrorCode::kRefused, std::move(text));
}

}  // namespace

Result<Mission> ReadMission(const std::filesystem::path& file,
                            const std::vector<std::string>& robots) {
  const auto document = ReadYamlFile(file);
  if (!document) return tl::unexpected(document.error());
  try {
    return MissionReader{robots}.Read(*document);
  } catch (const YAML::Exception& error) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}:{}: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

FieldGoals::FieldGoals(const std::map<std::string, std::string>& world_of_robot,
                       const GoalOptions& options, const Mission& mission,
                       const std::map<std::string, KeptGoals>& stored)
    : to_find_(static_cast<std::size_t>(options.to_find)) {
  for (const auto& [name, world] : world_of_robot) {
    KeptGoals kept;
    const auto given = mission.find(name);
    if (given != mission.end()) kept.mission = TextOf(given->second);
    const auto before = stored.find(name);
    if (before != stored.end()) kept.goals = before->second.goals;
    const bool continues = before != stored.end() && before->second.mission == kept.mission &&
                           before->second.goals.world == world;
    if (!continues) {
      const SimTime stamp = kept.goals.stamp;  // goes on rising
      kept.goals = {};
      kept.goals.stamp = stamp;
      if (given != mission.end()) kept.goals.left = given->second;
    }
    kept.goals.total = TotalOf(kept.goals);
    kept.goals.world = world;
    kept.goals.robot = name;
    kept.goals.tolerance_m = options.tolerance_m;
    robots_[name].kept = std::move(kept);
  }
}

std::uint32_t FieldGoals::TotalOf(const RobotGoals& goals) const {
  return static_cast<std::uint32_t>(std::max(to_find_, goals.left.size() + goals.reached.size()));
}

SimTime FieldGoals::NextStamp(const Robot& robot) {
  const SimTime after{robot.kept.goals.stamp.nanoseconds + 1};
  return robot.state ? std::max(after, robot.state->stamp) : after;
}

bool FieldGoals::DropOutside(Robot& robot) {
  std::vector<Position>& left = robot.kept.goals.left;
  const GridGeometry& grid = robot.state->grid;
  const auto is_outside = [&](Position goal) { return !grid.Contains(grid.PositionToCell(goal)); };
  const auto first = std::ranges::find_if(left, is_outside);
  if (first == left.end()) return false;
  robot.outside =
      fmt::format("{} of its goals, the first at {} m, outside of its map of {}",
                  std::ranges::count_if(left, is_outside), Describe(*first), conav::Describe(grid));
  std::erase_if(left, is_outside);
  return true;
}

std::optional<KeptGoals> FieldGoals::Receive(const RobotState& state) {
  const auto found = robots_.find(state.robot);
  if (found == robots_.end() || found->second.kept.goals.world != state.world) return std::nullopt;
  Robot& robot = found->second;
  const bool is_first = !robot.state;
  const bool other_map = is_first || robot.state->grid != state.grid;
  robot.state = state;
  robot.keeps_goals = state.goals_stamp != SimTime{};
  if (robot.keeps_goals) return std::nullopt;
  RobotGoals& goals = robot.kept.goals;
  bool changes = is_first && goals.stamp == SimTime{};
  if (other_map) changes = DropOutside(robot) || changes;
  for (const Position goal : std::vector<Position>(goals.left)) {
    if (!Reaches(state, goal, goals.tolerance_m)) continue;
    std::erase(goals.left, goal);
    goals.reached.push_back(goal);
    changes = true;
  }
  if (changes) {
    goals.stamp = NextStamp(robot);
    goals.total = TotalOf(goals);
  }
  return changes || is_first ? std::optional(robot.kept) : std::nullopt;
}

Result<KeptGoals> FieldGoals::Change(const GoalsRequest& request) const {
  const auto found = robots_.find(request.robot);
  if (found == robots_.end()) {
    return Refused(
        fmt::format("the goals of {0} are not given here: operator.goals.robots does not "
                    "name it",
                    request.robot));
  }
  const Robot& robot = found->second;
  if (!robot.state) return Refused(fmt::format("robot {} has not reported yet", request.robot));
  if (robot.keeps_goals) return Refused(request.robot + " keeps its goals itself");
  const GridGeometry& grid = robot.state->grid;
  const auto in_cell_of = [&](Position place) {
    return [&grid, cell = grid.PositionToCell(place)](Position other) {
      return grid.PositionToCell(other) == cell;
    };
  };
  KeptGoals kept = robot.kept;
  RobotGoals& goals = kept.goals;
  for (const Position place : request.remove) std::erase_if(goals.left, in_cell_of(place));
  const bool removed = goals.left.size() < robot.kept.goals.left.size();
  if (!removed && request.add.empty()) {
    return Fail(ErrorCode::kNotFound, request.robot + " has no such goal left");
  }
  for (const Position place : request.add) {
    if (!grid.Contains(grid.PositionToCell(place))) {
      return Refused(fmt::format("goal {} m lies outside of {}'s map of {}", Describe(place),
                                 request.robot, conav::Describe(grid)));
    }
    if (std::ranges::any_of(goals.left, in_cell_of(place))) continue;
    std::erase_if(goals.reached, in_cell_of(place));  // again
    goals.left.push_back(place);
  }
  if (goals.left.size() > kMostGoals) {
    return Refused(fmt::format("{} would have {} goals left; the limit is {}", request.robot,
                               goals.left.size(), kMostGoals));
  }
  goals.total = TotalOf(goals);
  goals.stamp = NextStamp(robot);
  return kept;
}

void FieldGoals::Adopt(const KeptGoals& kept) {
  const auto found = robots_.find(kept.goals.robot);
  if (found == robots_.end()) return;
  found->second.kept = kept;
  found->second.outside.clear();
}

}  // namespace conav::operators
