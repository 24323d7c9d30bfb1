#include <fmt/core.h>

#include <algorithm>
#include <mutex>
#include <set>

#include "common/runtime/threads.h"
#include "nhpm/dataset/annotators.h"
#include "nhpm/dataset/synthesize.h"
#include "operator/simulated/path_planner.h"

namespace conav::nhpm {
namespace {

Result<void> CheckOptions(const OracleOptions& options) {
  if (options.draws < kFewestOracleDraws) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} draws per segment: the oracle needs at least {}", options.draws,
                            kFewestOracleDraws));
  }
  if (options.threads >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("threads = {}: at least 1 is needed", options.threads));
}

Result<std::vector<PerceptionAnswer>> AnswersOf(const Trajectory& trajectory,
                                                const OracleOptions& options) {
  const auto annotator = FromNamedValues(trajectory.annotator);
  if (!annotator) return tl::unexpected(annotator.error());
  const std::uint64_t seed = DeriveSeed(options.seed, trajectory.annotator_seed);
  std::vector<PerceptionAnswer> answers;
  operators::PictureMemory memory;
  for (std::size_t i = 0; i < trajectory.segments.size(); ++i) {
    const PerceptionQuery& query = trajectory.segments[i].query;
    if (const auto good = CheckPerceptionQuery(query); !good) {
      return Fail(good.error().code, fmt::format("segment {}: {}", i, good.error().text));
    }
    Random random(DeriveSeed(seed, i));
    answers.push_back(OracleAnswer(*annotator, query, options.draws, random, memory));
    operators::Remember(SnapshotOf(query), memory);
  }
  return answers;
}

/// Calls answer(i) for each i below `count`, on the threads of the options, with progress.
void ForEach(std::size_t count, const OracleOptions& options,
             const std::function<void(std::size_t)>& answer) {
  std::mutex mutex;  // guards `done` and the progress callback
  std::size_t done = 0;
  RunOnWorkers(options.threads, static_cast<int>(count), [&](int, int index) {
    answer(static_cast<std::size_t>(index));
    const std::lock_guard lock(mutex);
    ++done;
    if (options.progress) options.progress(done, count);
  });
}

}  // namespace

PerceptionAnswer OracleAnswer(const operators::SnapshotReaderParameters& annotator,
                              const PerceptionQuery& query, int draws, Random& random,
                              const operators::PictureMemory& memory) {
  return AverageOracleAnswer({&annotator, 1}, query, draws, random, memory);
}

PerceptionAnswer AverageOracleAnswer(std::span<const operators::SnapshotReaderParameters> people,
                                     const PerceptionQuery& query, int draws, Random& random,
                                     const operators::PictureMemory& memory) {
  DEMAND(!people.empty());
  const BeliefGrid& belief = query.belief;
  const Snapshot snapshot = SnapshotOf(query);
  Grid<int> counts(belief.rows(), belief.columns());
  std::set<Cell> possible;
  for (const operators::SnapshotReaderParameters& person : people) {
    const operators::SnapshotReading reading(person, belief, snapshot, {}, memory);
    for (int i = 0; i < draws; ++i) {
      for (const CellEdit& edit : reading.Draw(random)) ++counts[edit.cell];
    }
    for (const Cell cell : reading.PossibleCells()) possible.insert(cell);
  }
  const double looks = static_cast<double>(draws) * static_cast<double>(people.size());
  PerceptionAnswer answer{{belief.rows(), belief.columns()}, {belief.rows(), belief.columns()}};
  for (const Cell cell : possible) {
    auto& channel = operators::IsWall(belief, cell) ? answer.remove : answer.add;
    channel[cell] = static_cast<float>((counts[cell] + 0.5) / (looks + 1.0));
  }
  return answer;
}

std::vector<PerceptionAnswer> AverageOracleAnswers(
    std::span<const operators::SnapshotReaderParameters> people,
    std::span<const PerceptionQuery> queries, const OracleOptions& options) {
  const int draws = std::max(1, options.draws / static_cast<int>(people.size()));
  std::vector<PerceptionAnswer> answers(queries.size());
  ForEach(queries.size(), options, [&](std::size_t i) {
    Random random(DeriveSeed(options.seed, i));
    answers[i] = AverageOracleAnswer(people, queries[i], draws, random);
  });
  return answers;
}

Result<std::vector<std::vector<PerceptionAnswer>>> OracleAnswers(
    std::span<const Trajectory> trajectories, const OracleOptions& options) {
  if (const auto good = CheckOptions(options); !good) return tl::unexpected(good.error());
  std::vector<Result<std::vector<PerceptionAnswer>>> results(trajectories.size());
  ForEach(trajectories.size(), options,
          [&](std::size_t i) { results[i] = AnswersOf(trajectories[i], options); });
  std::vector<std::vector<PerceptionAnswer>> answers;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i]) {
      return Fail(results[i].error().code,
                  fmt::format("trajectory {} ({}): {}", i, trajectories[i].session,
                              results[i].error().text));
    }
    answers.push_back(*std::move(results[i]));
  }
  return answers;
}

}  // namespace conav::nhpm
