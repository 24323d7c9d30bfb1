#include "sim/world/world_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "common/grid/geometry.h"
#include "common/runtime/random.h"
#include "sim/world/map_corruption.h"
#include "sim/world/world_site.h"

namespace conav::sim {
namespace {

/// The largest connected free area; of several equally large ones the northernmost.
std::set<Cell> LargestFreeArea(const OccupancyGrid& truth) {
  std::set<Cell> largest;
  std::set<Cell> seen;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    if (truth[cell] != Occupancy::kFree || seen.contains(cell)) continue;
    std::set<Cell> area = ReachableCells(truth, cell);
    seen.insert(area.begin(), area.end());
    if (area.size() > largest.size()) largest = std::move(area);
  }
  return largest;
}

/// Draws cells without repetition: the preferred ones first, in random order, then the others.
class CellDeck {
 public:
  CellDeck(std::vector<Cell> preferred, const std::set<Cell>& all, Random& random) {
    std::vector<Cell> others;
    for (const Cell cell : all) {
      if (std::find(preferred.begin(), preferred.end(), cell) == preferred.end()) {
        others.push_back(cell);
      }
    }
    std::erase_if(preferred, [&](Cell cell) { return !all.contains(cell); });
    random.Shuffle(preferred);
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
      if (taken.insert(cell).second) return cell;
    }
    return Fail(ErrorCode::kOutOfRange, "no free cell is left");
  }

 private:
  std::vector<Cell> cells_;  // the next one last
};

/// Purposes for DeriveSeed.
constexpr std::uint64_t kStartSeed = 1;
constexpr std::uint64_t kGoalSeed = 2;
constexpr std::uint64_t kCorruptionSeed = 3;

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
  if (!in_unit(options.wrong_share) || !in_unit(options.false_wall_share)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("wrong_share = {} and false_wall_share = {} must be in [0, 1]",
                            options.wrong_share, options.false_wall_share));
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

Result<void> PlaceStarts(const Site& site, const WorldOptions& options, std::set<Cell>& taken,
                         WorldSpec& spec) {
  const auto robots = static_cast<std::size_t>(options.robots);
  if (!options.starts.empty()) {
    if (options.starts.size() != robots) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} starts are given for {} robots", options.starts.size(), robots));
    }
    spec.starts = options.starts;
    taken.insert(options.starts.begin(), options.starts.end());
    return CheckCells(site.truth, options.starts, "start");
  }
  Random random(DeriveSeed(options.seed, kStartSeed));
  CellDeck deck(site.spawns, LargestFreeArea(site.truth), random);
  auto starts = DrawCells(deck, robots, taken, [&](std::size_t n) {
    return fmt::format("robot {} of {} has no place to start", n, robots);
  });
  if (!starts) return tl::unexpected(starts.error());
  spec.starts = *std::move(starts);
  return {};
}

Result<void> PlaceGoals(const Site& site, const WorldOptions& options, std::set<Cell>& taken,
                        WorldSpec& spec) {
  const std::size_t robots = spec.starts.size();
  if (!options.goals.empty()) {
    spec.goals.assign(robots, options.goals);
    for (std::size_t robot = 0; robot < robots; ++robot) {
      if (std::ranges::find(options.goals, spec.starts[robot]) == options.goals.end()) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("start {} of robot {} is a goal", spec.starts[robot], robot + 1));
    }
    return CheckCells(site.truth, options.goals, "goal");
  }
  const int count = options.goals_per_robot > 0 ? options.goals_per_robot : site.goals;
  Random random(DeriveSeed(options.seed, kGoalSeed));
  CellDeck deck(site.objects, ReachableCells(site.truth, spec.starts.front()), random);
  for (std::size_t robot = 0; robot < robots; ++robot) {
    if (robot > 0 && options.shared_goals) {
      spec.goals.push_back(spec.goals.front());
      continue;
    }
    auto goals = DrawCells(deck, static_cast<std::size_t>(count), taken, [&](std::size_t n) {
      return fmt::format("goal {} of {} of robot {} has no place", n, count, robot + 1);
    });
    if (!goals) return tl::unexpected(goals.error());
    spec.goals.push_back(*std::move(goals));
  }
  return {};
}

Result<void> CheckReachable(const WorldSpec& spec) {
  for (std::size_t robot = 0; robot < spec.starts.size(); ++robot) {
    const std::set<Cell> reachable = ReachableCells(spec.truth, spec.starts[robot]);
    for (const Cell goal : spec.goals[robot]) {
      if (reachable.contains(goal)) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("goal {} cannot be reached from the start {} of robot {}", goal,
                              spec.starts[robot], robot + 1));
    }
  }
  return {};
}

Result<void> MakeHumanMap(Site& site, const WorldOptions& options, const std::set<Cell>& kept,
                          WorldSpec& spec) {
  if (site.plan.has_value()) {
    spec.human_map = *std::move(site.plan);
    return {};
  }
  MapCorruptionOptions corruption;
  corruption.wrong_share = options.wrong_share;
  corruption.false_wall_share = options.false_wall_share;
  Result<OccupancyGrid> map =
      CorruptMap(spec.truth, kept, corruption, DeriveSeed(options.seed, kCorruptionSeed));
  if (!map) return tl::unexpected(map.error());
  spec.human_map = *std::move(map);
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
  spec.start_heading_rad = WrapAngle(spec.start_heading_rad + std::numbers::pi / 2);
  spec.truth = QuarterTurn(spec.truth);
  spec.human_map = QuarterTurn(spec.human_map);
  spec.wall_classes = QuarterTurn(spec.wall_classes);
  spec.floor_classes = QuarterTurn(spec.floor_classes);
  return spec;
}

}  // namespace

Result<WorldSpec> MakeWorldSpec(const WorldOptions& options) {
  if (const auto valid = CheckOptions(options); !valid) return tl::unexpected(valid.error());
  Result<Site> site = MakeSite(options);
  if (!site) return tl::unexpected(site.error());
  WorldSpec spec;
  spec.truth = site->truth;
  spec.wall_classes = site->wall_classes;
  spec.floor_classes = site->floor_classes;
  spec.cell_size_m = site->cell_size_m;
  spec.shared_goals = options.shared_goals;
  // Given goals first: no start is drawn on one.
  std::set<Cell> taken(options.goals.begin(), options.goals.end());
  const Result<void> placed =
      PlaceStarts(*site, options, taken, spec)
          .and_then([&] { return PlaceGoals(*site, options, taken, spec); })
          .and_then([&] { return CheckReachable(spec); })
          .and_then([&] { return MakeHumanMap(*site, options, taken, spec); });
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
