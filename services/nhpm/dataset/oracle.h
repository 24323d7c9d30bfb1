#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "operator/simulated/picture_reader.h"

namespace conav::nhpm {

inline constexpr int kFewestOracleDraws = 2000;

struct OracleOptions {
  int draws = 20000;  // per segment, at least kFewestOracleDraws
  std::uint64_t seed = 1;
  int threads = 1;
  /// Reports progress: answered trajectories (or segments) of all; from one thread at a time.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// How a SYNTHETIC person with these parameters edits the map of `query`, by Monte Carlo: `draws`
/// looks of the PictureReader that made the data. A model cannot beat this on average without
/// knowing who looked, up to the filter: data keeps the trajectories that ended well
/// (kAcceptedMappingAccuracy), which is unknown during a look.
///
/// A cell that was edited k times in n draws gets (k + 1/2) / (n + 1) (Jeffreys), so that an event
/// outside all draws costs little when it happens; the bias is below 1 / (2 n + 2) a cell. Cells
/// that the reader cannot edit at all get exactly 0.
/// The query passed CheckPerceptionQuery; its belief is 0 or 1 in each cell.
PerceptionAnswer OracleAnswer(const operators::PictureReaderParameters& annotator,
                              const PerceptionQuery& query, int draws, Random& random);

/// The mean of OracleAnswer over `people`, with `draws` looks of each. All looks count together, n
/// = draws times people, so that only cells that none of them can edit get 0. Requires at least one
/// person.
PerceptionAnswer AverageOracleAnswer(std::span<const operators::PictureReaderParameters> people,
                                     const PerceptionQuery& query, int draws, Random& random);

/// AverageOracleAnswer to each query, which passed CheckPerceptionQuery, with `options.draws` looks
/// in all, but at least one per person. Equal options give equal answers whatever the number of
/// threads. Requires at least one person and one thread.
std::vector<PerceptionAnswer> AverageOracleAnswers(
    std::span<const operators::PictureReaderParameters> people,
    std::span<const PerceptionQuery> queries, const OracleOptions& options = {});

/// One answer per segment of each trajectory, in order. Equal options give equal answers whatever
/// the number of threads, and a trajectory's answers do not depend on the others.
/// Errors: kInvalidArgument, with the trajectory's index and session, when it has no parameters of
/// a synthetic annotator (or wrong ones) or a query is impossible; and for too few draws or
/// threads.
[[nodiscard]] Result<std::vector<std::vector<PerceptionAnswer>>> OracleAnswers(
    std::span<const Trajectory> trajectories, const OracleOptions& options = {});

}  // namespace conav::nhpm
