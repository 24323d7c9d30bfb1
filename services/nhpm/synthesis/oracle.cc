#include "nhpm/synthesis/oracle.h"

#include <fmt/format.h>

#include "common/runtime/workers.h"
#include "nhpm/synthesis/annotator_population.h"
#include "nhpm/synthesis/mapping_task.h"
#include "operator/simulated/path_planner.h"

namespace conav::nhpm {
namespace {

Result<void> CheckOptions(const OracleOptions& options) {
  if (options.draws < kFewestOracleDraws) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} draws a segment: the oracle needs at least {}", options.draws,
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
  for (std::size_t i = 0; i < trajectory.segments.size(); ++i) {
    const PerceptionQuery& query = trajectory.segments[i].query;
    if (const auto good = CheckPerceptionQuery(query); !good) {
      return Fail(good.error().code, fmt::format("segment {}: {}", i, good.error().text));
    }
    Random random(DeriveSeed(seed, i));
    answers.push_back(OracleAnswer(*annotator, query, options.draws, random));
  }
  return answers;
}

}  // namespace

PerceptionAnswer OracleAnswer(const operators::PictureReaderParameters& annotator,
                              const PerceptionQuery& query, int draws, Random& random) {
  const BeliefGrid& belief = query.belief;
  const operators::PictureReading reading(annotator, belief, PictureOf(query), {});
  Grid<int> counts(belief.rows(), belief.columns());
  for (int i = 0; i < draws; ++i) {
    for (const CellEdit& edit : reading.Draw(random)) ++counts[edit.cell];
  }
  PerceptionAnswer answer{{belief.rows(), belief.columns()}, {belief.rows(), belief.columns()}};
  for (const Cell cell : reading.PossibleCells()) {
    auto& channel = operators::IsWall(belief, cell) ? answer.remove : answer.add;
    channel[cell] = static_cast<float>((counts[cell] + 0.5) / (draws + 1.0));
  }
  return answer;
}

Result<std::vector<std::vector<PerceptionAnswer>>> OracleAnswers(
    std::span<const Trajectory> trajectories, const OracleOptions& options) {
  if (const auto good = CheckOptions(options); !good) return tl::unexpected(good.error());
  std::vector<Result<std::vector<PerceptionAnswer>>> results(trajectories.size());
  RunOnWorkers(options.threads, static_cast<int>(trajectories.size()), [&](int, int index) {
    const auto i = static_cast<std::size_t>(index);
    results[i] = AnswersOf(trajectories[i], options);
  });
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
