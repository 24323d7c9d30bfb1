#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/grid/mapping_tour.h"
#include "common/msg/planning.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "nhpm/dataset/annotators.h"
#include "operator/simulated/snapshot_reader.h"
#include "sim/world/map_corruption.h"

namespace conav::nhpm {

/// The mapping task's maze, robot and pictures.
struct MappingTaskOptions {
  std::string preset = "conav13";  // of the maze; see sim/world/maze_presets.h
  sim::MapCorruptionOptions corruption;
  MappingTourOptions tour;
};

/// The dataset collection task of paper Appendix A with a SYNTHETIC annotator, in a maze of its own
/// with a corrupted map. The robot drives the shortest way from stop to stop of a MappingTour: all
/// goals, then `annotator.extra_pictures` more. At each it takes a picture with the lens of the
/// simulated camera, and the annotator edits the map.
///
/// Gives one segment per picture; the caller decides whether the trajectory is good enough to keep
/// (kAcceptedMappingAccuracy). Participant and session stay empty. Seeded: equal arguments give
/// equal trajectories.
/// Errors: kInvalidArgument for options out of range; those of MakeWorldSpec (kNotFound for an
///         unknown preset) and CorruptMap.
[[nodiscard]] Result<Trajectory> RunMappingTask(const MappingTaskOptions& options,
                                                const Annotator& annotator, std::uint64_t seed);

/// The picture of a segment's query, as a SnapshotReader looks at it.
Snapshot SnapshotOf(const PerceptionQuery& query);

struct SynthesisOptions {
  int trajectories = 400;  // accepted ones, at least 1
  std::uint64_t seed = 1;
  AnnotatorPopulation population;
  MappingTaskOptions task;
  /// Mazes that each person maps, one after the other, failed ones included. Paper Appendix A.
  int trajectories_per_person = 3;
  int threads = 1;
  /// The file that keeps wave `number` of the candidates; null or "" = no file.
  std::function<std::filesystem::path(std::size_t number)> wave_file;
  /// Reports progress now and then: accepted and excluded trajectories so far.
  std::function<void(int accepted, int excluded)> progress;
};

struct Synthesis {
  SegmentSet set;    // exactly as many trajectories as requested
  int excluded = 0;  // failed the filter before the last accepted one
};

/// Trajectories of SYNTHETIC annotators, each in a maze of its own, until the requested number has
/// a final mapping accuracy above kAcceptedMappingAccuracy; leaves the others out (paper Appendix
/// A: 254 of 367).
///
/// Equal options give equal trajectories, whatever the number of threads; a larger number begins
/// with the same ones.
/// Errors: kInvalidArgument (fewer than one trajectory, per person, or thread), those of
///         RunMappingTask, kOutOfRange when the population is so careless that fewer than one in a
///         hundred trajectories is accepted.
[[nodiscard]] Result<Synthesis> SynthesizeSegments(const SynthesisOptions& options);

/// Makes wave `number` of the candidates, the rejected ones too, which SynthesizeSegments then finds
/// in its file. Errors: those of SynthesizeSegments and WriteSegmentFile.
[[nodiscard]] Result<void> KeepWave(const SynthesisOptions& options, std::size_t number);
/// About how many waves that takes; a few more or less are needed.
std::size_t ExpectedWaves(int trajectories);

inline constexpr int kFewestOracleDraws = 2000;

struct OracleOptions {
  int draws = 20000;  // per segment, at least kFewestOracleDraws
  std::uint64_t seed = 1;
  int threads = 1;
  /// Reports progress: answered trajectories (or segments) of all; from one thread at a time.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// How a SYNTHETIC person with these parameters edits the map of `query`, by Monte Carlo: `draws`
/// looks of the SnapshotReader that made the data. A model cannot beat this on average without
/// knowing who looked, up to the filter: data keeps the trajectories that ended well
/// (kAcceptedMappingAccuracy), which is unknown during a look.
///
/// A cell that was edited k times in n draws gets (k + 1/2) / (n + 1) (Jeffreys), so that an event
/// outside all draws costs little when it happens; the bias is below 1 / (2 n + 2) a cell. Cells
/// that the reader cannot edit at all get exactly 0.
/// The query passed CheckPerceptionQuery; its belief is 0 or 1 in each cell. `memory`: what the
/// person saw before.
PerceptionAnswer OracleAnswer(const operators::SnapshotReaderParameters& annotator,
                              const PerceptionQuery& query, int draws, Random& random,
                              const operators::PictureMemory& memory = {});

/// The mean of OracleAnswer over `people`, with `draws` looks of each. All looks count together, n
/// = draws times people, so that only cells that none of them can edit get 0. Requires at least one
/// person.
PerceptionAnswer AverageOracleAnswer(std::span<const operators::SnapshotReaderParameters> people,
                                     const PerceptionQuery& query, int draws, Random& random,
                                     const operators::PictureMemory& memory = {});

/// AverageOracleAnswer to each query, which passed CheckPerceptionQuery, with `options.draws` looks
/// in all, but at least one per person. Equal options give equal answers whatever the number of
/// threads. Requires at least one person and one thread.
std::vector<PerceptionAnswer> AverageOracleAnswers(
    std::span<const operators::SnapshotReaderParameters> people,
    std::span<const PerceptionQuery> queries, const OracleOptions& options = {});

/// One answer per segment of each trajectory, in order. Equal options give equal answers whatever
/// the number of threads, and a trajectory's answers do not depend on the others.
/// Errors: kInvalidArgument, with the trajectory's index and session, when it has no parameters of
/// a synthetic annotator (or wrong ones) or a query is impossible; and for too few draws or
/// threads.
[[nodiscard]] Result<std::vector<std::vector<PerceptionAnswer>>> OracleAnswers(
    std::span<const Trajectory> trajectories, const OracleOptions& options = {});

}  // namespace conav::nhpm
