#include <fmt/format.h>

#include <algorithm>

#include "common/segments/segment_labels.h"
#include "nhpm/commands/evaluate_rows.h"
#include "nhpm/synthesis/annotator_population.h"
#include "nhpm/synthesis/oracle.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kAveragePeople = 100;  // at most, for the mean over people

bool IsSynthetic(const Trajectory& trajectory) {
  return trajectory.origin == SegmentOrigin::kSynthetic;
}

ModelIdentity IdentityOf(const char* name, const std::string& version) {
  return {name, version, ""};
}

OracleOptions OptionsOf(const EvaluateArguments& arguments, const Teller& progress,
                        const char* what) {
  return {.draws = arguments.oracle_draws,
          .threads = arguments.threads,
          .progress = [&progress, what](std::size_t done, std::size_t total) {
            progress(fmt::format("{} {} of {}", what, done, total));
          }};
}

Result<ModelRow> OracleRow(const EvaluateArguments& arguments, const EvaluationData& data,
                           const Teller& progress) {
  auto by_trajectory =
      OracleAnswers(data.test.trajectories, OptionsOf(arguments, progress, "oracle: trajectory"));
  if (!by_trajectory) {
    return Fail(by_trajectory.error().code,
                fmt::format("{}: test part: {}", data.file, by_trajectory.error().text));
  }
  std::vector<PerceptionAnswer> answers;
  for (auto& some : *by_trajectory) std::ranges::move(some, std::back_inserter(answers));
  return EvaluateAnswers(
      {"oracle", "Oracle",
       fmt::format("the synthetic annotators themselves, {} draws a segment: nobody is better on "
                   "average, up to the filter of their trajectories",
                   arguments.oracle_draws)},
      IdentityOf("oracle", fmt::format("{} draws", arguments.oracle_draws)), std::move(answers),
      data);
}

/// Some of the synthetic people who edited the train part, evenly spread over it.
Result<std::vector<operators::PictureReaderParameters>> People(const EvaluationData& data) {
  std::vector<std::size_t> synthetic;
  for (std::size_t i = 0; i < data.train.trajectories.size(); ++i) {
    if (IsSynthetic(data.train.trajectories[i])) synthetic.push_back(i);
  }
  if (synthetic.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no synthetic people in the train part", data.file));
  }
  const std::size_t count = std::min(synthetic.size(), kAveragePeople);
  std::vector<operators::PictureReaderParameters> people;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = synthetic[i * synthetic.size() / count];
    const Trajectory& trajectory = data.train.trajectories[index];
    const auto person = FromNamedValues(trajectory.annotator);
    if (!person) {
      return Fail(person.error().code,
                  fmt::format("{}: train part: trajectory {} ({}): {}", data.file, index,
                              trajectory.session, person.error().text));
    }
    people.push_back(*person);
  }
  return people;
}

Result<ModelRow> AverageRow(const EvaluateArguments& arguments, const EvaluationData& data,
                            const Teller& progress) {
  const auto people = People(data);
  if (!people) return tl::unexpected(people.error());
  return EvaluateAnswers(
      {"oracle_average", "Oracle, average",
       fmt::format("mean over {} synthetic annotators: knows how people edit, not who looked",
                   people->size())},
      IdentityOf("oracle_average", fmt::format("{} people", people->size())),
      AverageOracleAnswers(*people, Queries(data.test),
                           OptionsOf(arguments, progress, "average of people: segment")),
      data);
}

}  // namespace

bool HasOracle(const EvaluationData& data) {
  return std::ranges::all_of(data.test.trajectories, IsSynthetic);
}

Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                         const EvaluationData& data, const Teller& progress) {
  std::vector<ModelRow> rows;
  if (arguments.oracle_draws == 0 || !HasOracle(data)) return rows;
  auto oracle = OracleRow(arguments, data, progress);
  if (!oracle) return tl::unexpected(oracle.error());
  rows.push_back(std::move(*oracle));
  if (!arguments.average_oracle) return rows;
  auto average = AverageRow(arguments, data, progress);
  if (!average) return tl::unexpected(average.error());
  rows.push_back(std::move(*average));
  return rows;
}

}  // namespace conav::nhpm
