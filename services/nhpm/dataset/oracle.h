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
  /// Told how many trajectories (or segments) of all are answered; by one thread at a time.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// How a SYNTHETIC person with these parameters edits the map of `query`, by Monte Carlo: `draws`
/// looks of the same PictureReader that made the data. None knows more than who looked, so no model
/// can beat it on average, up to the filter: data keeps the trajectories that ended well
/// (kAcceptedMappingAccuracy), which nobody knows while they look.
///
/// A cell that was edited k times in n draws gets (k + 1/2) / (n + 1) (Jeffreys), so that an event
/// which no draw showed costs little when it happens; the bias is below 1 / (2 n + 2) a cell. Cells
/// that the reader cannot edit at all get exactly 0.
/// The query passed CheckPerceptionQuery; its belief is 0 or 1 in each cell.
PerceptionAnswer OracleAnswer(const operators::PictureReaderParameters& annotator,
                              const PerceptionQuery& query, int draws, Random& random);

/// The mean over `people` of what OracleAnswer says, with `draws` looks of each: all their looks are
/// counted together, n = draws times people, so that only cells that none of them can edit get 0.
/// Requires at least one person.
PerceptionAnswer AverageOracleAnswer(std::span<const operators::PictureReaderParameters> people,
                                     const PerceptionQuery& query, int draws, Random& random);

/// AverageOracleAnswer to each query, which passed CheckPerceptionQuery, with `options.draws` looks
/// in all, but one of each person at least. Equal options give equal answers whatever the number of
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
