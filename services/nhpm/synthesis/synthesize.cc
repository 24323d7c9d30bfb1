#include "nhpm/synthesis/synthesize.h"

#include <fmt/format.h>

#include <optional>

#include "common/runtime/workers.h"

namespace conav::nhpm {
namespace {

/// Purposes for DeriveSeed.
constexpr std::uint64_t kPersonSeed = 1;
constexpr std::uint64_t kTaskSeed = 2;

constexpr std::size_t kWave = 64;  // candidates between two looks at the count
constexpr int kLeastAcceptedPerMille = 10;
constexpr int kFairTrial = 1000;  // candidates, before a population is called too careless

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

/// Candidate `index`, good or bad.
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

std::vector<Result<Trajectory>> MakeWave(const SynthesisOptions& options, std::size_t first) {
  std::vector<Result<Trajectory>> wave(kWave);
  RunOnWorkers(options.threads, static_cast<int>(kWave), [&](int, int index) {
    const auto i = static_cast<std::size_t>(index);
    wave[i] = MakeCandidate(options, first + i);
  });
  return wave;
}

bool TooCareless(std::size_t accepted, std::size_t tried) {
  return tried >= kFairTrial && accepted * 1000 < tried * kLeastAcceptedPerMille;
}

/// Takes the candidates in their order until there are enough.
Result<void> TakeAccepted(std::vector<Result<Trajectory>> wave, std::size_t wanted,
                          Synthesis& synthesis) {
  for (Result<Trajectory>& candidate : wave) {
    if (synthesis.set.trajectories.size() == wanted) break;
    if (!candidate) return tl::unexpected(candidate.error());
    if (candidate->final_mapping_accuracy > kAcceptedMappingAccuracy) {
      synthesis.set.trajectories.push_back(*std::move(candidate));
    } else {
      ++synthesis.excluded;
    }
  }
  return {};
}

}  // namespace

Result<Synthesis> SynthesizeSegments(const SynthesisOptions& options) {
  if (const auto good = CheckOptions(options); !good) return tl::unexpected(good.error());
  const auto wanted = static_cast<std::size_t>(options.trajectories);
  Synthesis synthesis;
  const std::vector<Trajectory>& accepted = synthesis.set.trajectories;
  for (std::size_t tried = 0; accepted.size() < wanted; tried += kWave) {
    if (TooCareless(accepted.size(), tried)) {
      return Fail(ErrorCode::kOutOfRange,
                  fmt::format("only {} of {} trajectories have a mapping accuracy above {}: the "
                              "annotators are too careless",
                              accepted.size(), tried, kAcceptedMappingAccuracy));
    }
    const auto taken = TakeAccepted(MakeWave(options, tried), wanted, synthesis);
    if (!taken) return tl::unexpected(taken.error());
    if (options.progress) {
      options.progress(static_cast<int>(accepted.size()), synthesis.excluded);
    }
  }
  return synthesis;
}

}  // namespace conav::nhpm
