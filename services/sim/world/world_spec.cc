#include "sim/world/world_spec.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "common/grid/geometry.h"
#include "common/runtime/random.h"
#include "sim/world/clearance.h"
#include "sim/world/map_corruption.h"
#include "sim/world/world_site.h"

namespace conav::sim {
namespace {

/// Room for the robots around each cell; in mazes they keep to the middles of cells.
double RadiusCells(const WorldOptions& options, const Site& site) {
  return site.open ? (options.robot_radius_m + kOpenMarginM) / site.cell_size_m : 0.0;
}

/// A site and where its robots fit.
struct Ground {
  Site site;
  Grid<std::uint8_t> room;
  /// In open terrain starts and goals are this far apart.
  int spacing_cells = 0;

  /// No other start or goal may be where `cell` is one.
  void Take(Cell cell, std::set<Cell>& taken) const {
    for (int row = -spacing_cells; row <= spacing_cells; ++row) {
      for (int column = -spacing_cells; column <= spacing_cells; ++column) {
        if (row * row + column * column <= spacing_cells * spacing_cells) {
          taken.insert(cell + Cell{row, column});
        }
      }
    }
  }
};

std::vector<Cell> ReachableFrom(const Grid<std::uint8_t>& room, Cell from) {
  const Grid<int> steps = StepsFrom(room, from);
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps.values()[i] >= 0) cells.push_back(steps.CellAt(i));
  }
  return cells;
}

/// Draws cells without repetition: the preferred ones first, in random order if a maze has them,
/// then the others.
class CellDeck {
 public:
  /// `all` is sorted.
  CellDeck(const Ground& ground, std::vector<Cell> preferred, const std::vector<Cell>& all,
           Random& random)
      : ground_(ground) {
    std::vector<Cell> others;
    for (const Cell cell : all) {
      if (std::find(preferred.begin(), preferred.end(), cell) == preferred.end()) {
        others.push_back(cell);
      }
    }
    std::erase_if(preferred, [&](Cell cell) { return !std::ranges::binary_search(all, cell); });
    if (!ground.site.open) random.Shuffle(preferred);
    random.Shuffle(others);
    cells_.assign(others.rbegin(), others.rend());
    cells_.insert(cells_.end(), preferred.rbegin(), preferred.rend());
  }

  /// The next cell that is not in `taken`, and adds it there. Errors: kOutOfRange when none is
  /// left.
  Result<Cell> Draw(std::set<Cell>& taken) {
    while (!cells_.empty()) {
      const Cell cell = cells_.back();
      cells_.pop_back();
      if (taken.contains(cell)) continue;
      ground_.Take(cell, taken);
      return cell;
    }
    return Fail(ErrorCode::kOutOfRange, "no free cell is left");
  }

 private:
  const Ground& ground_;
  std::vector<Cell> cells_;  // the next one last
};

/// Purposes for DeriveSeed.
constexpr std::uint64_t kStartSeed = 1;
constexpr std::uint64_t kGoalSeed = 2;
constexpr std::uint64_t kCorruptionSeed = 3;
constexpr std::uint64_t kWingSeed = 4;
constexpr std::uint64_t kDoorSeed = 5;

/// The error says which radius would do, if one would.
Result<void> TooSmall(const WorldOptions& options, const Site& site, const std::string& what,
                      double widest_cells) {
  const double needed_m = options.robot_radius_m + kOpenMarginM;
  const double radius_m = widest_cells * site.cell_size_m - kOpenMarginM;
  std::string remedy = "not even for a smaller robot";
  if (radius_m >= kMinRobotRadiusM) {
    remedy = fmt::format("a radius of {:.3g} m would do", radius_m);
    if (site.scalable) {
      remedy += fmt::format(", or cells of {:.3g} m", needed_m / widest_cells);
    } else {
      remedy += ", and smaller cells (map.cell_size_m) keep narrow passages";
    }
  }
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("the map is too small for a robot with a radius of {} m: {}; {}",
                          options.robot_radius_m, what, remedy));
}

Result<void> CheckOptions(const WorldOptions& options) {
  const auto in_unit = [](double value) { return value >= 0.0 && value <= 1.0; };
  if (options.robots < 1) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("robots = {}: a world needs at least one", options.robots));
  }
  if (options.goals_per_robot < 0) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("goals_per_robot = {} is negative", options.goals_per_robot));
  }
  if (!(options.robot_radius_m >= kMinRobotRadiusM && options.robot_radius_m <= kMaxRobotRadiusM)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("robot_radius_m = {} is not in [{}, {}]", options.robot_radius_m,
                            kMinRobotRadiusM, kMaxRobotRadiusM));
  }
  if (!options.map_yaml.empty() && !options.height_map.image.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} and {}: a world has one map", options.map_yaml.string(),
                            options.height_map.image.string()));
  }
  if (!in_unit(options.wrong_share) || !in_unit(options.false_wall_share)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("wrong_share = {} and false_wall_share = {} must be in [0, 1]",
                            options.wrong_share, options.false_wall_share));
  }
  if (options.wing_error != WingError::kNone &&
      (!options.map_yaml.empty() || options.preset == kWaterwayPreset)) {
    return Fail(ErrorCode::kInvalidArgument, "wing_error: only maps of mazes have wings");
  }
  if (options.map_yaml.empty() && !options.operator_map_yaml.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("the operator's map {} needs a map of the truth",
                            options.operator_map_yaml.string()));
  }
  return {};
}

/// Given starts and goals: free cells, each once.
Result<void> CheckCells(const OccupancyGrid& truth, const std::vector<Cell>& cells,
                        const char* what) {
  std::set<Cell> seen;
  for (const Cell cell : cells) {
    if (!truth.Contains(cell)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} {} is outside of the {} x {} map", what, cell, truth.rows(),
                              truth.columns()));
    }
    if (truth[cell] != Occupancy::kFree) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{} {} is a wall", what, cell));
    }
    if (!seen.insert(cell).second) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{} {} is given twice", what, cell));
    }
  }
  return {};
}

/// `count` cells of the deck; `name` says what the n-th of them is for.
template <class Name>
Result<std::vector<Cell>> DrawCells(CellDeck& deck, std::size_t count, std::set<Cell>& taken,
                                    Name&& name) {
  std::vector<Cell> cells;
  while (cells.size() < count) {
    const Result<Cell> cell = deck.Draw(taken);
    if (!cell) {
      return Fail(cell.error().code,
                  fmt::format("{}: {}", name(cells.size() + 1), cell.error().text));
    }
    cells.push_back(*cell);
  }
  return cells;
}

/// Robots that start at `cells` have room there.
Result<void> CheckRoom(const Ground& ground, const WorldOptions& options,
                       const std::vector<Cell>& cells, const char* what) {
  for (const Cell cell : cells) {
    if (ground.room[cell] != 0) continue;
    return TooSmall(options, ground.site, fmt::format("{} {} is too near to a wall", what, cell),
                    WidestRadius(ground.site.truth, cell, cell));
  }
  return {};
}

/// In open terrain it may be for their size that robots and goals find no place.
Result<void> NoPlace(const Ground& ground, const WorldOptions& options, const Error& error) {
  if (!ground.site.open) return tl::unexpected(error);
  const double widest = WidestRadius(ground.site.truth);
  if (widest >= RadiusCells(options, ground.site)) return tl::unexpected(error);
  return TooSmall(options, ground.site, error.text, widest);
}

Result<void> PlaceStarts(const Ground& ground, const WorldOptions& options, std::set<Cell>& taken,
                         WorldSpec& spec) {
  const Site& site = ground.site;
  const auto robots = static_cast<std::size_t>(options.robots);
  if (!options.starts.empty()) {
    if (options.starts.size() != robots) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} starts are given for {} robots", options.starts.size(), robots));
    }
    spec.starts = options.starts;
    taken.insert(options.starts.begin(), options.starts.end());
    return CheckCells(site.truth, options.starts, "start").and_then([&] {
      return CheckRoom(ground, options, options.starts, "start");
    });
  }
  Random random(DeriveSeed(options.seed, kStartSeed));
  CellDeck deck(ground, site.spawns, LargestArea(ground.room), random);
  auto starts = DrawCells(deck, robots, taken, [&](std::size_t n) {
    return fmt::format("robot {} of {} has no place to start", n, robots);
  });
  if (!starts) return NoPlace(ground, options, starts.error());
  spec.starts = *std::move(starts);
  return {};
}

Result<void> PlaceGoals(const Ground& ground, const WorldOptions& options, std::set<Cell>& taken,
                        WorldSpec& spec) {
  const Site& site = ground.site;
  const std::size_t robots = spec.starts.size();
  if (!options.goals.empty()) {
    spec.goals.assign(robots, options.goals);
    for (std::size_t robot = 0; robot < robots; ++robot) {
      if (std::ranges::find(options.goals, spec.starts[robot]) == options.goals.end()) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("start {} of robot {} is a goal", spec.starts[robot], robot + 1));
    }
    return CheckCells(site.truth, options.goals, "goal").and_then([&] {
      return CheckRoom(ground, options, options.goals, "goal");
    });
  }
  const int count = options.goals_per_robot > 0 ? options.goals_per_robot : site.goals;
  Random random(DeriveSeed(options.seed, kGoalSeed));
  CellDeck deck(ground, site.objects, ReachableFrom(ground.room, spec.starts.front()), random);
  for (std::size_t robot = 0; robot < robots; ++robot) {
    if (robot > 0 && options.shared_goals) {
      spec.goals.push_back(spec.goals.front());
      continue;
    }
    auto goals = DrawCells(deck, static_cast<std::size_t>(count), taken, [&](std::size_t n) {
      return fmt::format("goal {} of {} of robot {} has no place", n, count, robot + 1);
    });
    if (!goals) return NoPlace(ground, options, goals.error());
    spec.goals.push_back(*std::move(goals));
  }
  return {};
}

/// `kept` gets the shortest ways and the room that robots need on them.
Result<void> CheckReachable(const Ground& ground, const WorldOptions& options,
                            const WorldSpec& spec, Grid<std::uint8_t>& kept) {
  OccupancyGrid ways(kept.rows(), kept.columns(), Occupancy::kFree);
  for (std::size_t robot = 0; robot < spec.starts.size(); ++robot) {
    const Cell start = spec.starts[robot];
    const Grid<int> steps = StepsFrom(ground.room, start);
    for (const Cell goal : spec.goals[robot]) {
      const std::string what = fmt::format(
          "goal {} cannot be reached from the start {} of robot {}", goal, start, robot + 1);
      for (const Cell cell : WayBack(steps, goal)) ways[cell] = Occupancy::kOccupied;
      if (steps[goal] >= 0) continue;
      const double widest = spec.open ? WidestRadius(spec.truth, start, goal) : -1.0;
      if (widest >= 0.0) return TooSmall(options, ground.site, what, widest);
      return Fail(ErrorCode::kInvalidArgument, what);
    }
  }
  if (!spec.open) return {};
  kept = RoomFor(ways, RadiusCells(options, ground.site) + 1.0);
  for (std::uint8_t& cell : kept.values()) cell = cell == 0 ? 1 : 0;
  return {};
}

Result<void> MakeHumanMap(Site& site, const WorldOptions& options, const std::set<Cell>& taken,
                          const Grid<std::uint8_t>& kept, WorldSpec& spec) {
  if (site.plan.has_value()) {
    spec.human_map = *std::move(site.plan);
    return {};
  }
  MapCorruptionOptions corruption;
  corruption.wrong_share = options.wrong_share;
  corruption.false_wall_share = options.false_wall_share;
  const std::uint64_t seed = DeriveSeed(options.seed, kCorruptionSeed);
  Result<OccupancyGrid> map = spec.open ? SiltMap(spec.truth, kept, corruption, seed)
                                        : CorruptMap(spec.truth, taken, corruption, seed);
  if (!map) return tl::unexpected(map.error());
  spec.human_map = *std::move(map);
  if (options.wing_error == WingError::kNone) return {};
  Random random(DeriveSeed(options.seed, kWingSeed));
  const Wing wing{static_cast<int>(random.Uniform(0, 3)), options.wing_error,
                  random.Chance(0.5) ? 2 : -2};
  spec.human_map = WithError(spec.human_map, wing);
  for (const Cell cell : taken) spec.human_map[cell] = Occupancy::kFree;
  return {};
}

/// From the first robot's start over its goals, the nearest next.
std::vector<Cell> FirstTour(const Grid<std::uint8_t>& room, const WorldSpec& spec) {
  std::vector<Cell> tour{spec.starts.front()};
  std::vector<Cell> left = spec.goals.front();
  while (!left.empty()) {
    const Grid<int> steps = StepsFrom(room, tour.back());
    const auto next = std::ranges::min_element(left, {}, [&](Cell goal) { return steps[goal]; });
    std::vector<Cell> way = WayBack(steps, *next);
    tour.insert(tour.end(), way.rbegin() + 1, way.rend());
    left.erase(next);
  }
  return tour;
}

bool ReachesAllGoals(const Grid<std::uint8_t>& room, const WorldSpec& spec) {
  for (std::size_t robot = 0; robot < spec.starts.size(); ++robot) {
    const Grid<int> steps = StepsFrom(room, spec.starts[robot]);
    for (const Cell goal : spec.goals[robot]) {
      if (steps[goal] < 0) return false;
    }
  }
  return true;
}

Result<void> DrawDoors(Grid<std::uint8_t> room, const WorldOptions& options,
                       const std::set<Cell>& taken, WorldSpec& spec) {
  if (options.closing_doors == 0) return {};
  if (spec.open)
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("closing_doors = {}: open terrain has no doors", options.closing_doors));
  const std::vector<Cell> tour = FirstTour(room, spec);
  std::vector<int> order(tour.size());
  std::iota(order.begin(), order.end(), 0);
  Random random(DeriveSeed(options.seed, kDoorSeed));
  random.Shuffle(order);
  for (const int at : order) {
    if (static_cast<int>(spec.doors.size()) == options.closing_doors) break;
    const Cell cell = tour[static_cast<std::size_t>(at)];
    if (taken.contains(cell) || room[cell] == 0) continue;
    room[cell] = 0;
    if (ReachesAllGoals(room, spec)) {
      spec.doors.push_back({cell, at / 2});
    } else {
      room[cell] = 1;
    }
  }
  return {};
}

/// The place of a cell after a quarter turn of a grid with `columns` columns.
Cell QuarterTurn(Cell cell, int columns) { return {columns - 1 - cell.column, cell.row}; }

template <class T>
Grid<T> QuarterTurn(const Grid<T>& grid) {
  Grid<T> turned(grid.columns(), grid.rows());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    turned[QuarterTurn(grid.CellAt(i), grid.columns())] = grid.values()[i];
  }
  return turned;
}

WorldSpec QuarterTurn(WorldSpec spec) {
  const int columns = spec.truth.columns();
  for (Cell& start : spec.starts) start = QuarterTurn(start, columns);
  for (std::vector<Cell>& goals : spec.goals) {
    for (Cell& goal : goals) goal = QuarterTurn(goal, columns);
  }
  for (Door& door : spec.doors) door.cell = QuarterTurn(door.cell, columns);
  spec.start_heading_rad = WrapAngle(spec.start_heading_rad + std::numbers::pi / 2);
  spec.truth = QuarterTurn(spec.truth);
  spec.human_map = QuarterTurn(spec.human_map);
  spec.wall_classes = QuarterTurn(spec.wall_classes);
  spec.floor_classes = QuarterTurn(spec.floor_classes);
  spec.heights = QuarterTurn(spec.heights);
  return spec;
}

}  // namespace

Result<WorldSpec> MakeWorldSpec(const WorldOptions& options) {
  if (const auto valid = CheckOptions(options); !valid) return tl::unexpected(valid.error());
  Result<Site> site = MakeSite(options);
  if (!site) return tl::unexpected(site.error());
  Ground ground{*std::move(site), {}};
  const double radius_cells = RadiusCells(options, ground.site);
  ground.room = RoomFor(ground.site.truth, radius_cells);
  if (ground.site.open) ground.spacing_cells = static_cast<int>(std::ceil(2.0 * radius_cells)) + 1;
  WorldSpec spec;
  spec.truth = ground.site.truth;
  spec.wall_classes = ground.site.wall_classes;
  spec.floor_classes = ground.site.floor_classes;
  spec.heights = ground.site.heights;
  spec.cell_size_m = ground.site.cell_size_m;
  spec.open = ground.site.open;
  spec.shared_goals = options.shared_goals;
  // Given goals first: no start is drawn on one.
  std::set<Cell> taken(options.goals.begin(), options.goals.end());
  Grid<std::uint8_t> kept(spec.truth.rows(), spec.truth.columns(), 0);
  const Result<void> placed =
      PlaceStarts(ground, options, taken, spec)
          .and_then([&] { return PlaceGoals(ground, options, taken, spec); })
          .and_then([&] { return CheckReachable(ground, options, spec, kept); })
          .and_then([&] { return MakeHumanMap(ground.site, options, taken, kept, spec); })
          .and_then([&] { return DrawDoors(ground.room, options, taken, spec); });
  if (!placed) return tl::unexpected(placed.error());
  return Rotated(std::move(spec), options.rotation_deg);
}

Result<WorldSpec> Rotated(WorldSpec spec, int rotation_deg) {
  if (rotation_deg < 0 || rotation_deg > 270 || rotation_deg % 90 != 0) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("rotation_deg = {} is not 0, 90, 180 or 270", rotation_deg));
  }
  for (int turned = 0; turned < rotation_deg; turned += 90) spec = QuarterTurn(std::move(spec));
  return spec;
}

}  // namespace conav::sim
