#include "launcher/run_log.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <regex>
#include <utility>

#include "sim/world/clearance.h"
#include "sim/world/episode.h"

namespace conav::launcher {
namespace {

void Append(std::vector<Cell>& trajectory, const std::vector<Cell>& path) {
  for (const Cell cell : path) {
    if (trajectory.empty() || trajectory.back() != cell) trajectory.push_back(cell);
  }
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Cells around a map from which no leg leads out of the grid.
constexpr int kLegReach = 4;

/// A straight way from a cell's middle to another's, and the cells that it touches, both sides of a
/// corner included, as differences of indices.
struct Leg {
  int target = 0;
  double length = 0.0;
  std::vector<int> touched;
};

/// Samples at which a leg is in every cell that it touches, and in its corner exactly.
constexpr int kLegSamples = 64;

Leg MakeLeg(int rows, int columns, int grid_columns) {
  Leg leg{.target = rows * grid_columns + columns, .length = std::hypot(rows, columns)};
  for (int i = 1; i <= kLegSamples; ++i) {
    const double row = static_cast<double>(rows) * i / kLegSamples;
    const double column = static_cast<double>(columns) * i / kLegSamples;
    for (const double north : {std::ceil(row - 0.5), std::floor(row + 0.5)}) {
      for (const double west : {std::ceil(column - 0.5), std::floor(column + 0.5)}) {
        const int touched = static_cast<int>(north) * grid_columns + static_cast<int>(west);
        const bool is_new = std::ranges::find(leg.touched, touched) == leg.touched.end();
        if (touched != 0 && is_new) leg.touched.push_back(touched);
      }
    }
  }
  return leg;
}

/// Moves to neighbours, or legs in all directions.
std::vector<Leg> MakeLegs(bool anywhere, int grid_columns) {
  const int reach = anywhere ? kLegReach : 1;
  std::vector<Leg> legs;
  for (int rows = -reach; rows <= reach; ++rows) {
    for (int columns = -reach; columns <= reach; ++columns) {
      const bool is_move = std::abs(rows) + std::abs(columns) == 1;
      if (std::gcd(rows, columns) != 1 || (!anywhere && !is_move)) continue;
      legs.push_back(MakeLeg(rows, columns, grid_columns));
    }
  }
  return legs;
}

/// Shortest ways over the cells of a map in which a robot fits.
class Ways {
 public:
  Ways(const OccupancyGrid& map, std::optional<double> radius_cells)
      : room_(map.rows() + 2 * kLegReach, map.columns() + 2 * kLegReach, 0),
        legs_(MakeLegs(radius_cells.has_value(), room_.columns())) {
    const Grid<std::uint8_t> room = sim::RoomFor(map, radius_cells.value_or(0.0));
    for (std::size_t i = 0; i < map.size(); ++i) room_[Inside(map.CellAt(i))] = room.values()[i];
  }

  /// Lengths from `start` to each of `ends`, infinite where no way leads.
  std::vector<double> Lengths(Cell start, const std::vector<Cell>& ends) const {
    std::vector<double> lengths(room_.size(), kInfinity);
    std::vector<std::uint8_t> is_end(room_.size(), 0);
    for (const Cell end : ends) is_end[room_.IndexOf(Inside(end))] = 1;
    auto ends_left = std::ranges::count(is_end, 1);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;  // Dijkstra
    const std::size_t first = room_.IndexOf(Inside(start));
    if (room_.values()[first] != 0) queue.emplace(lengths[first] = 0.0, first);
    while (!queue.empty() && ends_left > 0) {
      const auto [length, cell] = queue.top();
      queue.pop();
      if (length > lengths[cell]) continue;
      ends_left -= is_end[cell];
      for (const Leg& leg : legs_) {
        double& known = lengths[At(cell, leg.target)];
        if (length + leg.length >= known || !IsOpen(cell, leg)) continue;
        known = length + leg.length;
        queue.emplace(known, At(cell, leg.target));
      }
    }
    std::vector<double> found;
    for (const Cell end : ends) found.push_back(lengths[room_.IndexOf(Inside(end))]);
    return found;
  }

 private:
  static Cell Inside(Cell cell) { return cell + Cell{kLegReach, kLegReach}; }
  static std::size_t At(std::size_t cell, int difference) {
    return cell + static_cast<std::size_t>(difference);
  }
  bool IsOpen(std::size_t from, const Leg& leg) const {
    return std::ranges::all_of(leg.touched,
                               [&](int cell) { return room_.values()[At(from, cell)] != 0; });
  }

  Grid<std::uint8_t> room_;
  std::vector<Leg> legs_;
};

}  // namespace

/// Held and Karp, "A dynamic programming approach to sequencing problems", 1962: the shortest way
/// through each set of goals that ends at each of them.
double ShortestTour(const OccupancyGrid& truth, Cell start, const std::vector<Cell>& goals,
                    std::optional<double> radius_cells) {
  const std::size_t count = goals.size();
  std::vector<Cell> ends = goals;
  ends.push_back(start);
  const auto is_inside = [&](Cell cell) { return truth.Contains(cell); };
  if (count == 0 || count > kMostTourGoals || !std::ranges::all_of(ends, is_inside)) return 0.0;
  const Ways ways(truth, radius_cells);
  std::vector<std::vector<double>> from_goal;  // to each goal, then to the start
  for (const Cell goal : goals) from_goal.push_back(ways.Lengths(goal, ends));
  const std::size_t all = (std::size_t{1} << count) - 1;
  std::vector<std::vector<double>> length(all + 1, std::vector<double>(count, kInfinity));
  for (std::size_t g = 0; g < count; ++g) length[std::size_t{1} << g][g] = from_goal[g][count];
  for (std::size_t set = 1; set <= all; ++set) {
    for (std::size_t last = 0; last < count; ++last) {
      for (std::size_t next = 0; next < count; ++next) {
        if ((set >> next & 1U) != 0) continue;
        double& known = length[set | std::size_t{1} << next][next];
        known = std::min(known, length[set][last] + from_goal[last][next]);
      }
    }
  }
  const double shortest = *std::ranges::min_element(length[all]);
  return std::isfinite(shortest) ? shortest : 0.0;
}

namespace {

/// RobotMetrics::optimal_distance_m
double OptimalDistance(const Episode& episode, const WorldRecord& world, const RobotRecord& robot) {
  const double cell_m = world.cell_size_m;
  const Cell start = robot.trajectory.front();
  const OccupancyGrid& truth = world.first_truth ? *world.first_truth : *world.truth;
  if (!episode.open) return cell_m * ShortestTour(truth, start, robot.goals);
  const double tour = ShortestTour(truth, start, robot.goals, episode.robot_radius_m / cell_m);
  return std::max(cell_m * tour - sim::kOpenGoalM, 0.0);
}

}  // namespace

double EpisodeMetrics::path_over_optimum() const {
  double driven_m = 0.0;
  double optimal_m = 0.0;
  for (const RobotMetrics& robot : robots) {
    if (robot.optimal_distance_m == 0.0 || robot.goals_reached < robot.goals_total) return 0.0;
    driven_m += robot.distance_m;
    optimal_m += robot.optimal_distance_m;
  }
  return optimal_m > 0.0 ? driven_m / optimal_m : 0.0;
}

std::string EpisodeMetrics::operators() const {
  bool person = false;
  bool other = false;
  for (const auto& [name, client] : clients) {
    (client.at_page ? person : other) |= client.guided();
  }
  if (person) return other ? "person and simulated" : "person";
  return other ? "simulated" : "nobody";
}

bool RobotRecord::finished() const {
  return state && (hidden_goals.empty() ? state->goals_left.empty() : reached_all());
}

bool RobotRecord::reached_all() const { return state && goals_reached() == goals_total(); }

std::size_t RobotRecord::goals_reached() const {
  const std::vector<Cell>& reached = state->goals_reached;
  if (hidden_goals.empty()) return reached.size();
  return static_cast<std::size_t>(
      std::ranges::count_if(hidden_goals, [&](Cell goal) { return Contains(reached, goal); }));
}

std::size_t RobotRecord::goals_total() const {
  return hidden_goals.empty() ? state->goals_total : hidden_goals.size();
}

bool Episode::finished() const {
  return !robots.empty() && std::all_of(robots.begin(), robots.end(),
                                        [](const RobotRecord& robot) { return robot.finished(); });
}

bool Episode::all_goals_reached() const {
  if (!finished()) return false;
  // A robot with its own goals must have reached all of them; robots that share goals must have
  // reached them together.
  for (const WorldRecord& world : worlds) {
    std::size_t reached = 0;
    std::size_t total = 0;
    bool each_alone = true;
    for (const RobotRecord& robot : robots) {
      if (robot.world != world.name) continue;
      reached += robot.goals_reached();
      total = std::max(total, robot.goals_total());
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

bool IsNewer(const RobotRecord& robot, const RobotState& state) {
  if (!robot.state) return true;
  RobotState before = *robot.state;
  before.stamp = state.stamp;
  before.heading_rad = state.heading_rad;
  before.position = state.position;
  before.speed_mps = state.speed_mps;
  before.yaw_rate_rps = state.yaw_rate_rps;
  before.distance_m = state.distance_m;
  return before != state;
}

void Record(RobotRecord& robot, const RobotState& state) {
  if (!robot.state) {
    robot.goals = robot.hidden_goals.empty() ? state.goals_reached : robot.hidden_goals;
    robot.goals.insert(robot.goals.end(), state.goals_left.begin(), state.goals_left.end());
  }
  // Before the first picture the state's path begins at the start; later the pictures carry the
  // path.
  if (robot.trajectory.empty() && state.snapshots == 0) {
    robot.trajectory.push_back(state.path.empty() ? state.cell : state.path.front());
  }
  robot.path_since_snapshot = state.path;
  robot.state = state;
  if (robot.finished() && !robot.finished_at) robot.finished_at = state.stamp;
}

void Record(RobotRecord& robot, const Snapshot& snapshot) {
  if (snapshot.sequence_number <= robot.newest_snapshot) return;
  robot.newest_snapshot = snapshot.sequence_number;
  Append(robot.trajectory, snapshot.path);
  robot.snapshots.push_back({snapshot.cell, snapshot.heading_rad, snapshot.streamed});
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

namespace {

/// "Ben" of "Ben/2c81...", a page; "synthetic-operator" of "synthetic-operator-01a2176bd43c-4c91e7b4".
std::string NameOfClient(const std::string& client) {
  static const std::regex program("-[0-9a-f]{8,}-[0-9a-f]+$");
  const auto slash = client.find('/');
  return slash != std::string::npos ? client.substr(0, slash)
                                    : std::regex_replace(client, program, "");
}

}  // namespace

void Record(Episode& episode, const OperatorEvent& event) {
  ClientRecord& client = episode.clients[NameOfClient(event.client)];
  client.at_page = event.client.find('/') != std::string::npos;
  if (!event.accepted) {
    ++client.refused;
  } else if (event.kind == RequestKind::kEdit) {
    ++client.edits;
    client.cells += event.cells;
  } else if (event.kind == RequestKind::kGuide) {
    ++client.paths;
  } else if (event.kind == RequestKind::kAnswer) {
    ++client.answers;
  } else {
    ++client.other;
  }
}

std::vector<Cell> WholeTrajectory(const RobotRecord& robot) {
  std::vector<Cell> trajectory = robot.trajectory;
  // The state may be older than the newest picture; its path then adds nothing new.
  if (robot.state && robot.state->snapshots >= robot.newest_snapshot) {
    Append(trajectory, robot.path_since_snapshot);
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

double Percentile(std::span<const double> values, double share) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

RobotMetrics MeasureRobot(const RobotRecord& robot) {
  RobotMetrics metrics;
  metrics.name = robot.name;
  metrics.world = robot.world;
  metrics.guidance = robot.guidance_given;
  metrics.decisions = robot.decisions;
  metrics.perception_model = robot.perception_model;
  metrics.decision_ms_median = Percentile(robot.decision_ms, 0.5);
  metrics.decision_ms_p95 = Percentile(robot.decision_ms, 0.95);
  metrics.decision_ms_p99 = Percentile(robot.decision_ms, 0.99);
  if (!robot.state) return metrics;
  metrics.goals_reached = robot.goals_reached();
  metrics.goals_total = robot.goals_total();
  metrics.cell_moves = robot.state->cell_moves;
  metrics.distance_m = robot.state->distance_m;
  metrics.low_level_steps = robot.state->low_level_steps;
  metrics.images = robot.state->images;
  metrics.image_bytes = robot.state->image_bytes;
  metrics.camera_bytes = robot.state->camera_bytes;
  metrics.time_s = robot.finished_at.value_or(robot.state->stamp).ToSeconds();
  return metrics;
}

EpisodeMetrics Measure(const Episode& episode) {
  EpisodeMetrics metrics;
  metrics.all_goals_reached = episode.all_goals_reached();
  metrics.clients = episode.clients;
  for (const RobotRecord& robot : episode.robots) {
    metrics.robots.push_back(MeasureRobot(robot));
    const auto world = std::ranges::find(episode.worlds, robot.world, &WorldRecord::name);
    if (episode.shared_goals || robot.trajectory.empty() || !world->truth) continue;
    metrics.robots.back().optimal_distance_m = OptimalDistance(episode, *world, robot);
  }
  metrics.before = {.mapping = 0.0, .cell = 0.0};
  metrics.after = {.mapping = 0.0, .cell = 0.0};
  int known = 0;
  for (const WorldRecord& world : episode.worlds) {
    if (!world.truth || !world.initial_map) continue;
    const BeliefGrid initial = ToBelief(*world.initial_map);
    const BeliefGrid& now = world.belief ? world.belief->wall_probability : initial;
    const MapAccuracy before = CompareMaps(*world.truth, *world.initial_map, initial);
    const MapAccuracy after = CompareMaps(*world.truth, *world.initial_map, now);
    metrics.before.mapping += before.mapping;
    metrics.before.cell += before.cell;
    metrics.after.mapping += after.mapping;
    metrics.after.cell += after.cell;
    ++known;
  }
  if (known > 0) {
    for (MapAccuracy* accuracy : {&metrics.before, &metrics.after}) {
      accuracy->mapping /= known;
      accuracy->cell /= known;
    }
  }
  return metrics;
}

nlohmann::ordered_json ToJson(const EpisodeMetrics& metrics) {
  nlohmann::ordered_json robots = nlohmann::ordered_json::array();
  for (const RobotMetrics& robot : metrics.robots) {
    robots.push_back({{"name", robot.name},
                      {"world", robot.world},
                      {"goals_reached", robot.goals_reached},
                      {"goals_total", robot.goals_total},
                      {"cell_moves", robot.cell_moves},
                      {"distance_m", robot.distance_m},
                      {"optimal_distance_m", robot.optimal_distance_m},
                      {"low_level_steps", robot.low_level_steps},
                      {"pictures", robot.images},
                      {"picture_bytes", robot.image_bytes},
                      {"camera_bytes", robot.camera_bytes},
                      {"guidance", robot.guidance},
                      {"decisions", robot.decisions},
                      {"time_s", robot.time_s},
                      {"decision_ms_median", robot.decision_ms_median},
                      {"decision_ms_p95", robot.decision_ms_p95},
                      {"decision_ms_p99", robot.decision_ms_p99},
                      {"perception_model", robot.perception_model}});
  }
  nlohmann::ordered_json clients = nlohmann::ordered_json::array();
  for (const auto& [name, client] : metrics.clients) {
    clients.push_back({{"name", name},
                       {"at_page", client.at_page},
                       {"edits", client.edits},
                       {"cells", client.cells},
                       {"paths", client.paths},
                       {"answers", client.answers},
                       {"other", client.other},
                       {"refused", client.refused}});
  }
  return {{"operator", metrics.operators()},
          {"clients", std::move(clients)},
          {"all_goals_reached", metrics.all_goals_reached},
          {"mapping_accuracy_before", metrics.before.mapping},
          {"mapping_accuracy_after", metrics.after.mapping},
          {"cell_accuracy_before", metrics.before.cell},
          {"cell_accuracy_after", metrics.after.cell},
          {"path_over_optimum", metrics.path_over_optimum()},
          {"robots", std::move(robots)}};
}

}  // namespace conav::launcher
