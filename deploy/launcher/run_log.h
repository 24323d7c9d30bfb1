#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/map_accuracy.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"

namespace conav::launcher {

/// The part of a picture that the episode's record needs.
struct SentSnapshot {
  Cell cell;
  double heading_rad = 0.0;
  bool streamed = false;
};

/// The messages of one robot, from its first state to its newest.
struct RobotRecord {
  std::string name;
  std::string world;
  std::optional<RobotState> state;  // the newest; empty before the first message
  std::vector<Cell> goals;          // all that the first state names
  std::vector<Cell> hidden_goals;   // to be found: its state has those that were given to it
  std::vector<Cell> trajectory;     // entered cells in order; start first
  std::vector<SentSnapshot> snapshots;
  std::uint64_t newest_snapshot = 0;      // sequence number
  std::uint64_t guidance_given = 0;       // newest guidance revision
  std::uint64_t decisions = 0;            // number of the newest decision
  std::vector<double> decision_ms;        // wall time of each decision received
  std::string perception_model;           // the one that answered the newest decision
  std::vector<Cell> path_since_snapshot;  // of the newest state
  std::optional<SimTime> finished_at;     // when it first reported that it has no goals left

  bool finished() const;
  bool reached_all() const;
  /// Of the goals that stand in the world.
  std::size_t goals_reached() const;
  std::size_t goals_total() const;
};

/// The messages of one world.
struct WorldRecord {
  std::string name;
  std::optional<OccupancyGrid> truth;        // the newest: doors may close
  std::optional<OccupancyGrid> first_truth;  // of the shortest tours; if none, the newest
  double cell_size_m = 2.0;                  // of the truth
  std::optional<OccupancyGrid> initial_map;  // the operator's, before the first edit
  std::optional<Belief> belief;              // the newest revision
  std::uint64_t edits() const { return belief ? belief->revision : 0; }
};

/// What one client of the operator service did: a person at the console, the simulated operator, or
/// another program.
struct ClientRecord {
  bool at_page = false;  // of the console
  std::uint64_t edits = 0;
  std::uint64_t cells = 0;  // of these edits
  std::uint64_t paths = 0;
  std::uint64_t answers = 0;
  std::uint64_t other = 0;  // stops, goals, control, ...
  std::uint64_t refused = 0;

  /// It decided what the robots or the map get, not only who has control and when robots stand.
  bool guided() const { return edits + paths + answers > 0; }
};

/// A whole run as the launcher saw it, folded from messages.
struct Episode {
  std::vector<RobotRecord> robots;
  std::vector<WorldRecord> worlds;
  std::map<std::string, ClientRecord> clients;  // by name
  bool open = false;            // robots drive anywhere, not from cell to neighbouring cell
  double robot_radius_m = 0.0;  // in open terrain
  bool shared_goals = false;    // nobody has a tour of its own

  /// Every robot has reported that it has no goals left.
  bool finished() const;
  /// Every robot reached its goals; goals that robots share count once for the team.
  bool all_goals_reached() const;
};

/// `robots_per_world` robots in each of `worlds` worlds: r1, r2, ... numbered through w1, w2, ...
Episode MakeEpisode(int robots_per_world, int worlds);

/// Whether `state` differs in more than the time; a robot's pose only counts together with its
/// action.
bool IsNewer(const RobotRecord& robot, const RobotState& state);
void Record(RobotRecord& robot, const RobotState& state);
/// Ignores a picture that was recorded before.
void Record(RobotRecord& robot, const Snapshot& snapshot);
void Record(RobotRecord& robot, const Guidance& guidance);
void Record(RobotRecord& robot, const SearchReport& report);
/// Ignores an older revision.
void Record(WorldRecord& world, const Belief& belief);
/// Clients of one name count together: a person who opens another page remains that person.
void Record(Episode& episode, const OperatorEvent& event);

/// The trajectory up to the newest state: the cells up to the newest picture, then the later ones.
std::vector<Cell> WholeTrajectory(const RobotRecord& robot);

/// The operator's map as free and occupied cells, see kWallThreshold.
OccupancyGrid BeliefAsMap(const BeliefGrid& belief);

/// The value below which `share` of the values lie (nearest rank); 0 without values.
double Percentile(std::span<const double> values, double share);

struct RobotMetrics {
  std::string name;
  std::string world;
  std::uint64_t goals_reached = 0;
  std::uint64_t goals_total = 0;
  std::uint64_t cell_moves = 0;
  double distance_m = 0.0;  // driven
  /// Of the shortest tour over the true map from its start through all its goals, in the best order
  /// (ShortestTour()); in open terrain it ends sim::kOpenGoalM before the last, which is then reached.
  /// 0 = not known: goals are shared, more than kMostTourGoals, or not to be reached.
  double optimal_distance_m = 0.0;
  std::uint64_t low_level_steps = 0;  // of 0.25 s
  std::uint64_t images = 0;
  std::uint64_t image_bytes = 0;
  std::uint64_t camera_bytes = 0;  // of live views that people opened
  std::uint64_t guidance = 0;
  std::uint64_t decisions = 0;
  double time_s = 0.0;  // simulation time until its goals were reached, or until now
  double decision_ms_median = 0.0;
  double decision_ms_p95 = 0.0;
  double decision_ms_p99 = 0.0;
  // the one that answered the newest decision; includes "fallback: glpf"
  std::string perception_model;
};

struct EpisodeMetrics {
  bool all_goals_reached = false;
  MapAccuracy before;  // means over the worlds with known maps
  MapAccuracy after;
  std::vector<RobotMetrics> robots;
  std::map<std::string, ClientRecord> clients;  // by name

  /// Who guided the robots: "simulated", "person" (at the console), "person and simulated",
  /// "nobody".
  std::string operators() const;
  /// What all robots drove, over the sum of their shortest tours; 0 if one of these is not known or
  /// one of the robots has goals left.
  double path_over_optimum() const;
};

inline constexpr std::size_t kMostTourGoals = 12;

/// Length in cells of the shortest tour from the middle of `start` through those of all `goals`; 0
/// without goals or a tour. Without a radius it leads over neighbouring cells. With the radius of a
/// robot that drives anywhere (in cells, above 0) straight legs lead between cells up to four rows and
/// columns apart, and touch only cells in whose middle the robot fits; where nothing is in the way that
/// is at most 1 % longer than straight on.
double ShortestTour(const OccupancyGrid& truth, Cell start, const std::vector<Cell>& goals,
                    std::optional<double> radius_cells = std::nullopt);

RobotMetrics MeasureRobot(const RobotRecord& robot);
EpisodeMetrics Measure(const Episode& episode);

/// The object of --json without the facts that only the launcher knows (seed, method, ...).
nlohmann::ordered_json ToJson(const EpisodeMetrics& metrics);

/// The picture of a run as an SVG document. For each world three maps side by side: the truth with
/// trajectories, goals, starts and an arrow for each picture sent; the operator's map before; and
/// after, with the cells that differ from the truth marked. Plus a legend. Colours are those of
/// Okabe and Ito, which people with every common colour blindness can tell apart; each robot also
/// has its own dash pattern, each kind of error its own sign. A robot's own goals have its colour
/// and, among several robots, its name.
std::string EpisodeSvg(const Episode& episode, std::string_view title);

}  // namespace conav::launcher
