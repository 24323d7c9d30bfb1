#include "nhpm/dataset/synthesize.h"

#include <fmt/core.h>

#include <set>

#include "common/grid/map_accuracy.h"
#include "common/grid/visibility.h"
#include "common/runtime/threads.h"
#include "common/segments/segment_file.h"
#include "operator/simulated/path_planner.h"
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
      : world_(std::move(world)),
        belief_(ToBelief(world_.human_map)),
        tour_(world_.goals.front(), options.tour, DeriveSeed(seed, kRobotSeed)),
        reader_(annotator.reader, DeriveSeed(seed, kAnnotatorSeed)),
        cell_(world_.starts.front()) {}

  std::vector<Segment> Run(int extra_pictures) {
    const std::size_t goals = world_.goals.front().size();
    for (std::size_t i = 0; i < goals + static_cast<std::size_t>(extra_pictures); ++i) {
      if (i < goals) ++goals_reached_;
      VisitAndShow(tour_.Next(world_.truth, belief_, cell_));
    }
    return std::move(segments_);
  }

  MapAccuracy accuracy() const { return CompareMaps(world_.truth, world_.human_map, belief_); }
  const OccupancyGrid& truth() const { return world_.truth; }

 private:
  void VisitAndShow(const MappingStop& stop) {
    Segment segment;
    segment.step = static_cast<std::uint32_t>(segments_.size());
    segment.query = {belief_, WayTo(stop.cell), stop.cell, stop.heading_rad, {}};
    segment.query.visible = CastView(
        world_.truth, ViewThrough(CameraLens{}, stop.cell, stop.heading_rad, world_.cell_size_m));
    for (const CellEdit& edit : reader_.Read(belief_, SnapshotOf(segment.query), {})) {
      belief_[edit.cell] = edit.wall ? 1.0F : 0.0F;
    }
    segment.belief_after = belief_;
    segment.goals_reached = goals_reached_;
    segments_.push_back(std::move(segment));
    cell_ = stop.cell;
  }

  std::vector<Cell> WayTo(Cell target) const {
    Grid<double> costs(world_.truth.rows(), world_.truth.columns(), operators::kUnreachable);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (world_.truth.values()[i] == Occupancy::kFree) costs.values()[i] = 1.0;
    }
    return operators::CostField(costs, cell_).PathTo(target);
  }

  sim::WorldSpec world_;
  BeliefGrid belief_;  // the person's map
  MappingTour tour_;
  operators::SnapshotReader reader_;
  Cell cell_;  // of the robot
  std::uint32_t goals_reached_ = 0;
  std::vector<Segment> segments_;
};

/// A maze with start and goals; the errors of its map have a seed of their own.
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

/// Purposes for DeriveSeed.
constexpr std::uint64_t kPersonSeed = 1;
constexpr std::uint64_t kTaskSeed = 2;

constexpr std::size_t kWave = 64;  // candidates between two checks of the count
constexpr int kLeastAcceptedPerMille = 10;
constexpr int kFairTrial = 1000;  // candidates, before a population counts as too careless

Result<void> CheckOptions(const SynthesisOptions& options) {
  const auto at_least_one = [](const char* what, int value) -> Result<void> {
    if (value >= 1) return {};
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} = {}: at least 1 is needed", what, value));
  };
  return at_least_one("trajectories", options.trajectories)
      .and_then(
          [&] { return at_least_one("trajectories per person", options.trajectories_per_person); })
      .and_then([&] { return at_least_one("threads", options.threads); });
}

/// Candidate `index`, accepted or not.
Result<Trajectory> MakeCandidate(const SynthesisOptions& options, std::size_t index) {
  const std::size_t person = index / static_cast<std::size_t>(options.trajectories_per_person);
  Random random(DeriveSeed(DeriveSeed(options.seed, kPersonSeed), person));
  const Annotator annotator = DrawAnnotator(options.population, random);
  Result<Trajectory> trajectory = RunMappingTask(
      options.task, annotator, DeriveSeed(DeriveSeed(options.seed, kTaskSeed), index));
  if (!trajectory) return trajectory;
  trajectory->participant = fmt::format("synthetic-{}-{:05}", options.seed, person + 1);
  trajectory->session = fmt::format("{}-{:05}", options.seed, index + 1);
  return trajectory;
}

/// Reads wave `number` where it is kept, else makes and keeps it.
Result<std::vector<Trajectory>> MakeWave(const SynthesisOptions& options, std::size_t number) {
  const auto file = options.wave_file ? options.wave_file(number) : std::filesystem::path();
  if (!file.empty() && std::filesystem::exists(file)) {
    return ReadSegmentFile(file).map([](SegmentSet set) { return std::move(set.trajectories); });
  }
  std::vector<Result<Trajectory>> made(kWave);
  RunOnWorkers(options.threads, static_cast<int>(kWave), [&](int, int index) {
    const auto i = static_cast<std::size_t>(index);
    made[i] = MakeCandidate(options, number * kWave + i);
  });
  SegmentSet wave;
  for (Result<Trajectory>& candidate : made) {
    if (!candidate) return tl::unexpected(candidate.error());
    wave.trajectories.push_back(*std::move(candidate));
  }
  if (file.empty()) return std::move(wave.trajectories);
  return WriteSegmentFile(file, wave).map([&] { return std::move(wave.trajectories); });
}

bool TooCareless(std::size_t accepted, std::size_t tried) {
  return tried >= kFairTrial && accepted * 1000 < tried * kLeastAcceptedPerMille;
}

/// Accepts candidates in their order until there are enough.
void TakeAccepted(std::vector<Trajectory> wave, std::size_t wanted, Synthesis& synthesis) {
  for (Trajectory& candidate : wave) {
    if (synthesis.set.trajectories.size() == wanted) break;
    if (candidate.final_mapping_accuracy > kAcceptedMappingAccuracy) {
      synthesis.set.trajectories.push_back(std::move(candidate));
    } else {
      ++synthesis.excluded;
    }
  }
}

}  // namespace

Snapshot SnapshotOf(const PerceptionQuery& query) {
  Snapshot snapshot;
  snapshot.cell = query.cell;
  snapshot.heading_rad = query.heading_rad;
  snapshot.visible = query.visible;
  snapshot.path = query.path;
  return snapshot;
}

Result<Trajectory> RunMappingTask(const MappingTaskOptions& options, const Annotator& annotator,
                                  std::uint64_t seed) {
  if (const auto good = CheckMappingTourOptions(options.tour); !good)
    return tl::unexpected(good.error());
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

Result<Synthesis> SynthesizeSegments(const SynthesisOptions& options) {
  if (const auto good = CheckOptions(options); !good) return tl::unexpected(good.error());
  const auto wanted = static_cast<std::size_t>(options.trajectories);
  Synthesis synthesis;
  const std::vector<Trajectory>& accepted = synthesis.set.trajectories;
  for (std::size_t tried = 0; accepted.size() < wanted; tried += kWave) {
    if (TooCareless(accepted.size(), tried)) {
      return Fail(ErrorCode::kOutOfRange,
                  fmt::format("the annotators are too careless: only {} of {} trajectories have a "
                              "mapping accuracy above {}",
                              accepted.size(), tried, kAcceptedMappingAccuracy));
    }
    auto wave = MakeWave(options, tried / kWave);
    if (!wave) return tl::unexpected(wave.error());
    TakeAccepted(*std::move(wave), wanted, synthesis);
    if (options.progress) {
      options.progress(static_cast<int>(accepted.size()), synthesis.excluded);
    }
  }
  return synthesis;
}

Result<void> KeepWave(const SynthesisOptions& options, std::size_t number) {
  return CheckOptions(options)
      .and_then([&] { return MakeWave(options, number); })
      .map([](const auto&) {});
}

std::size_t ExpectedWaves(int trajectories) {
  constexpr std::size_t kAcceptedPercent = 65;  // Appendix A: 254 of 367
  return static_cast<std::size_t>(trajectories) * 100 / (kAcceptedPercent * kWave) + 1;
}

}  // namespace conav::nhpm
