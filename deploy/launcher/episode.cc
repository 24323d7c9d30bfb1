#include "launcher/episode.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/grid/map_accuracy.h"

namespace conav::launcher {
namespace {

void Append(std::vector<Cell>& trajectory, const std::vector<Cell>& path) {
  for (const Cell cell : path) {
    if (trajectory.empty() || trajectory.back() != cell) trajectory.push_back(cell);
  }
}

}  // namespace

bool RobotRecord::reached_all() const {
  return finished() && state->goals_reached.size() == state->goals_total;
}

bool Episode::finished() const {
  return !robots.empty() && std::all_of(robots.begin(), robots.end(),
                                        [](const RobotRecord& robot) { return robot.finished(); });
}

bool Episode::all_goals_reached() const {
  if (!finished()) return false;
  // A robot whose goals are its own reached as many as it had; the robots that share goals reached
  // them together.
  for (const WorldRecord& world : worlds) {
    std::size_t reached = 0;
    std::size_t total = 0;
    bool each_alone = true;
    for (const RobotRecord& robot : robots) {
      if (robot.world != world.name) continue;
      reached += robot.state->goals_reached.size();
      total = std::max<std::size_t>(total, robot.state->goals_total);
      each_alone = each_alone && robot.reached_all();
    }
    if (!each_alone && reached != total) return false;
  }
  return true;
}

Episode MakeEpisode(int robots_per_world, int worlds) {
  Episode episode;
  int number = 0;
  for (int w = 1; w <= worlds; ++w) {
    WorldRecord world;
    world.name = fmt::format("w{}", w);
    for (int r = 0; r < robots_per_world; ++r) {
      RobotRecord robot;
      robot.name = fmt::format("r{}", ++number);
      robot.world = world.name;
      episode.robots.push_back(std::move(robot));
    }
    episode.worlds.push_back(std::move(world));
  }
  return episode;
}

bool IsNews(const RobotRecord& robot, const RobotState& state) {
  if (!robot.state) return true;
  RobotState before = *robot.state;
  before.stamp = state.stamp;
  before.heading_rad = state.heading_rad;
  before.position = state.position;
  return before != state;
}

void Record(RobotRecord& robot, const RobotState& state) {
  if (!robot.state) {
    robot.goals = state.goals_reached;
    robot.goals.insert(robot.goals.end(), state.goals_left.begin(), state.goals_left.end());
  }
  // Without pictures so far the state's path begins at the start; otherwise the pictures tell it.
  if (robot.trajectory.empty() && state.snapshots == 0) {
    robot.trajectory.push_back(state.path.empty() ? state.cell : state.path.front());
  }
  robot.path_since_picture = state.path;
  robot.state = state;
  if (robot.finished() && !robot.finished_at) robot.finished_at = state.stamp;
}

void Record(RobotRecord& robot, const Picture& picture) {
  if (picture.sequence_number <= robot.newest_picture) return;
  robot.newest_picture = picture.sequence_number;
  Append(robot.trajectory, picture.path);
  robot.pictures.push_back({picture.cell, picture.heading_rad, picture.streamed});
}

void Record(RobotRecord& robot, const Guidance& guidance) {
  robot.guidance_given = std::max(robot.guidance_given, guidance.revision);
}

void Record(RobotRecord& robot, const SearchReport& report) {
  robot.decisions = std::max(robot.decisions, report.decision);
  robot.decision_ms.push_back(report.duration_ms);
  robot.perception_model = report.perception_model;
}

void Record(WorldRecord& world, const Belief& belief) {
  if (world.belief && belief.revision < world.belief->revision) return;
  world.belief = belief;
}

std::vector<Cell> WholeTrajectory(const RobotRecord& robot) {
  std::vector<Cell> trajectory = robot.trajectory;
  // The state may be older than the newest picture; its path then adds nothing that is new.
  if (robot.state && robot.state->snapshots >= robot.newest_picture) {
    Append(trajectory, robot.path_since_picture);
  }
  return trajectory;
}

OccupancyGrid BeliefAsMap(const BeliefGrid& belief) {
  OccupancyGrid map(belief.rows(), belief.columns(), Occupancy::kFree);
  for (std::size_t i = 0; i < belief.size(); ++i) {
    if (belief.values()[i] >= kWallThreshold) map.values()[i] = Occupancy::kOccupied;
  }
  return map;
}

}  // namespace conav::launcher
