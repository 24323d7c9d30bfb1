#include "nhpm/synthesis/mapping_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/grid/camera_lens.h"
#include "common/grid/map_accuracy.h"
#include "operator/simulated/cost_field.h"
#include "operator/simulated/path_planner.h"
#include "sim/world/world_cells.h"
#include "sim/world/world_spec.h"

namespace conav::nhpm {
namespace {

/// Purposes for DeriveSeed.
constexpr std::uint64_t kWorldSeed = 1;
constexpr std::uint64_t kCorruptionSeed = 2;
constexpr std::uint64_t kRobotSeed = 3;
constexpr std::uint64_t kAnnotatorSeed = 4;

/// One robot, one person, one maze.
class MappingTask {
 public:
  MappingTask(const MappingTaskOptions& options, sim::WorldSpec world, const Annotator& annotator,
              std::uint64_t seed)
      : options_(options),
        world_(std::move(world)),
        belief_(ToBelief(world_.human_map)),
        random_(DeriveSeed(seed, kRobotSeed)),
        reader_(annotator.reader, DeriveSeed(seed, kAnnotatorSeed)),
        cell_(world_.starts.front()) {
    for (const Cell cell : sim::ReachableCells(world_.truth, cell_)) reachable_.push_back(cell);
  }

  std::vector<Segment> Run(int extra_pictures) {
    std::vector<Cell> goals = world_.goals.front();
    random_.Shuffle(goals);
    for (const Cell goal : goals) {
      ++goals_reached_;
      VisitAndShow(goal);
    }
    for (int i = 0; i < extra_pictures; ++i) VisitAndShow(DrawTarget());
    return std::move(segments_);
  }

  MapAccuracy accuracy() const { return CompareMaps(world_.truth, world_.human_map, belief_); }
  const OccupancyGrid& truth() const { return world_.truth; }

 private:
  void VisitAndShow(Cell target) {
    Segment segment;
    segment.step = static_cast<std::uint32_t>(segments_.size());
    segment.query = {belief_, WayTo(target), target, DrawHeading(), {}};
    segment.query.visible =
        CastView(world_.truth,
                 ViewThrough(CameraLens{}, target, segment.query.heading_rad, world_.cell_size_m));
    for (const CellEdit& edit : reader_.Read(belief_, PictureOf(segment.query), {})) {
      belief_[edit.cell] = edit.wall ? 1.0F : 0.0F;
    }
    segment.belief_after = belief_;
    segment.goals_reached = goals_reached_;
    segments_.push_back(std::move(segment));
    cell_ = target;
  }

  std::vector<Cell> WayTo(Cell target) const {
    Grid<double> costs(world_.truth.rows(), world_.truth.columns(), operators::kUnreachable);
    for (const Cell cell : reachable_) costs[cell] = 1.0;
    return operators::CostField(costs, cell_).PathTo(target);
  }

  double DrawHeading() {
    return HeadingFromIndex(static_cast<int>(random_.Uniform(0, options_.headings - 1)),
                            options_.headings);
  }

  Cell DrawTarget() {
    const std::vector<Cell> wrong = WrongCells();
    std::vector<double> weights;
    double total = 0.0;
    for (const Cell cell : reachable_) {
      weights.push_back(cell == cell_ ? 0.0 : Attraction(cell, wrong));
      total += weights.back();
    }
    if (total == 0.0) return reachable_[DrawIndex(reachable_.size())];
    double rest = random_.Unit() * total;
    std::size_t chosen = 0;
    while (chosen + 1 < weights.size() && rest >= weights[chosen]) rest -= weights[chosen++];
    return reachable_[chosen];
  }

  std::size_t DrawIndex(std::size_t count) {
    return static_cast<std::size_t>(random_.Uniform(0, static_cast<std::int64_t>(count) - 1));
  }

  std::vector<Cell> WrongCells() const {
    std::vector<Cell> wrong;
    for (std::size_t i = 0; i < belief_.size(); ++i) {
      const Cell cell = belief_.CellAt(i);
      const bool wall = world_.truth[cell] == Occupancy::kOccupied;
      if (wall != operators::IsWall(belief_, cell)) wrong.push_back(cell);
    }
    return wrong;
  }

  double Attraction(Cell cell, const std::vector<Cell>& wrong) const {
    const auto near = std::count_if(wrong.begin(), wrong.end(), [&](Cell other) {
      const Cell way = other - cell;
      return std::hypot(way.row, way.column) <= options_.attraction_cells;
    });
    return options_.background + static_cast<double>(near);
  }

  MappingTaskOptions options_;
  sim::WorldSpec world_;
  BeliefGrid belief_;  // the person's map
  Random random_;
  operators::PictureReader reader_;
  std::vector<Cell> reachable_;  // row-major
  Cell cell_;                    // of the robot
  std::uint32_t goals_reached_ = 0;
  std::vector<Segment> segments_;
};

Result<void> CheckOptions(const MappingTaskOptions& options) {
  const auto in_range = [](const char* what, double value, double low,
                           double high) -> Result<void> {
    if (value >= low && value <= high) return {};
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} = {}: not from {} to {}", what, value, low, high));
  };
  constexpr double kLargest = std::numeric_limits<double>::max();
  return in_range("headings", options.headings, 1, 360)
      .and_then([&] { return in_range("background", options.background, 0.0, kLargest); })
      .and_then(
          [&] { return in_range("attraction_cells", options.attraction_cells, 0.0, kLargest); });
}

/// A maze with its start and goals; the map of it gets its mistakes from a seed of its own.
Result<sim::WorldSpec> MakeWorld(const MappingTaskOptions& options, std::uint64_t world_seed,
                                 std::uint64_t corruption_seed) {
  sim::WorldOptions world_options;
  world_options.seed = world_seed;
  world_options.preset = options.preset;
  world_options.wrong_share = 0.0;
  Result<sim::WorldSpec> world = sim::MakeWorldSpec(world_options);
  if (!world) return world;
  std::set<Cell> kept(world->goals.front().begin(), world->goals.front().end());
  kept.insert(world->starts.front());
  Result<OccupancyGrid> map =
      sim::CorruptMap(world->truth, kept, options.corruption, corruption_seed);
  if (!map) return tl::unexpected(map.error());
  world->human_map = *std::move(map);
  return world;
}

}  // namespace

Picture PictureOf(const PerceptionQuery& query) {
  Picture picture;
  picture.cell = query.cell;
  picture.heading_rad = query.heading_rad;
  picture.visible = query.visible;
  picture.path = query.path;
  return picture;
}

Result<Trajectory> RunMappingTask(const MappingTaskOptions& options, const Annotator& annotator,
                                  std::uint64_t seed) {
  if (const auto good = CheckOptions(options); !good) return tl::unexpected(good.error());
  Trajectory trajectory;
  trajectory.origin = SegmentOrigin::kSynthetic;
  trajectory.world = options.preset;
  trajectory.world_seed = DeriveSeed(seed, kWorldSeed);
  trajectory.corruption_seed = DeriveSeed(seed, kCorruptionSeed);
  trajectory.annotator = ToNamedValues(annotator.reader);
  trajectory.annotator_seed = DeriveSeed(seed, kAnnotatorSeed);
  Result<sim::WorldSpec> world =
      MakeWorld(options, trajectory.world_seed, trajectory.corruption_seed);
  if (!world) return tl::unexpected(world.error());

  MappingTask task(options, *std::move(world), annotator, seed);
  trajectory.truth = task.truth();
  trajectory.initial_cell_accuracy = task.accuracy().cell;
  trajectory.segments = task.Run(annotator.extra_pictures);
  trajectory.final_cell_accuracy = task.accuracy().cell;
  trajectory.final_mapping_accuracy = task.accuracy().mapping;
  return trajectory;
}

}  // namespace conav::nhpm
