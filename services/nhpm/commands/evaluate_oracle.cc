#include <fmt/format.h>

#include <algorithm>

#include "nhpm/commands/evaluate_rows.h"
#include "nhpm/synthesis/annotator_population.h"
#include "nhpm/synthesis/oracle.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kAveragePeople = 100;  // at most, for the mean over people

bool AllSynthetic(const SegmentSet& set) {
  return std::all_of(set.trajectories.begin(), set.trajectories.end(),
                     [](const Trajectory& t) { return t.origin == SegmentOrigin::kSynthetic; });
}

ModelIdentity IdentityOf(const char* name, const std::string& version) {
  return {name, version, ""};
}

Result<std::vector<PerceptionAnswer>> AskOracle(const EvaluateArguments& arguments,
                                                const EvaluationData& data,
                                                const Teller& progress) {
  const OracleOptions options{.draws = arguments.oracle_draws, .threads = arguments.threads};
  const std::span<const Trajectory> all = data.test.trajectories;
  const auto batch = static_cast<std::size_t>(arguments.threads);
  std::vector<PerceptionAnswer> answers;
  for (std::size_t done = 0; done < all.size(); done += batch) {
    progress(fmt::format("oracle: trajectory {} of {}", done + 1, all.size()));
    auto some = OracleAnswers(all.subspan(done, std::min(batch, all.size() - done)), options);
    if (!some) return tl::unexpected(some.error());
    for (auto& of_trajectory : *some) {
      std::move(of_trajectory.begin(), of_trajectory.end(), std::back_inserter(answers));
    }
  }
  return answers;
}

/// Some of the people who edited `set`, evenly spread over it.
Result<std::vector<operators::PictureReaderParameters>> People(const SegmentSet& set) {
  const std::size_t all = set.trajectories.size();
  const std::size_t count = std::min(all, kAveragePeople);
  std::vector<operators::PictureReaderParameters> people;
  for (std::size_t i = 0; i < count; ++i) {
    const auto person = FromNamedValues(set.trajectories[i * all / count].annotator);
    if (!person) return tl::unexpected(person.error());
    people.push_back(*person);
  }
  return people;
}

/// How often an edit was drawn, from what OracleAnswer makes of it: (k + 1/2) / (n + 1).
double Frequency(float probability, int draws) {
  if (probability == 0.0F) return 0.0;
  return std::max(0.0, (static_cast<double>(probability) * (draws + 1.0) - 0.5) / draws);
}

void AddMean(const PerceptionAnswer& one, int draws, double weight, Grid<double>& add,
             Grid<double>& remove) {
  for (std::size_t i = 0; i < add.size(); ++i) {
    add.values()[i] += weight * Frequency(one.add.values()[i], draws);
    remove.values()[i] += weight * Frequency(one.remove.values()[i], draws);
  }
}

/// The mean over people, smoothed as the oracle: 0 only where none of them can edit.
PerceptionAnswer MeanAnswer(const std::vector<operators::PictureReaderParameters>& people,
                            const PerceptionQuery& query, int draws, Random& random) {
  const int rows = query.belief.rows();
  const int columns = query.belief.columns();
  const int each = std::max(1, draws / static_cast<int>(people.size()));
  const double all = each * static_cast<double>(people.size());
  Grid<double> add(rows, columns);
  Grid<double> remove(rows, columns);
  Grid<std::uint8_t> possible(rows, columns);
  for (const auto& person : people) {
    const PerceptionAnswer one = OracleAnswer(person, query, each, random);
    AddMean(one, each, 1.0 / static_cast<double>(people.size()), add, remove);
    for (std::size_t i = 0; i < possible.size(); ++i) {
      if (one.add.values()[i] + one.remove.values()[i] > 0.0F) possible.values()[i] = 1;
    }
  }
  PerceptionAnswer answer{Grid<float>(rows, columns), Grid<float>(rows, columns)};
  for (std::size_t i = 0; i < possible.size(); ++i) {
    if (possible.values()[i] == 0) continue;
    const bool is_wall = query.belief.values()[i] >= 0.5F;
    const double frequency = (is_wall ? remove : add).values()[i];
    (is_wall ? answer.remove : answer.add).values()[i] =
        static_cast<float>((frequency * all + 0.5) / (all + 1.0));
  }
  return answer;
}

Result<ModelRow> AverageRow(const EvaluateArguments& arguments, const EvaluationData& data,
                            const Teller& progress) {
  const auto people = People(data.train.trajectories.empty() ? data.test : data.train);
  if (!people) return tl::unexpected(people.error());
  std::vector<PerceptionAnswer> answers;
  Random random(1);
  for (const Trajectory& trajectory : data.test.trajectories) {
    for (const Segment& segment : trajectory.segments) {
      progress(fmt::format("average of {} people: segment {}", people->size(), answers.size() + 1));
      answers.push_back(MeanAnswer(*people, segment.query, arguments.oracle_draws, random));
    }
  }
  return EvaluateAnswers(
      {"oracle_average", "Oracle, average",
       fmt::format("mean over {} synthetic annotators: knows how people edit, not who looked",
                   people->size())},
      IdentityOf("oracle_average", fmt::format("{} people", people->size())), std::move(answers),
      data);
}

}  // namespace

Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                         const EvaluationData& data, const Teller& progress) {
  std::vector<ModelRow> rows;
  if (arguments.oracle_draws == 0 || !AllSynthetic(data.test)) return rows;
  auto answers = AskOracle(arguments, data, progress);
  if (!answers) return tl::unexpected(answers.error());
  auto oracle = EvaluateAnswers(
      {"oracle", "Oracle",
       fmt::format("the synthetic annotators themselves, {} draws a segment: nobody can be better",
                   arguments.oracle_draws)},
      IdentityOf("oracle", fmt::format("{} draws", arguments.oracle_draws)), std::move(*answers),
      data);
  if (!oracle) return tl::unexpected(oracle.error());
  rows.push_back(std::move(*oracle));
  if (!arguments.average_oracle) return rows;
  auto average = AverageRow(arguments, data, progress);
  if (!average) return tl::unexpected(average.error());
  rows.push_back(std::move(*average));
  return rows;
}

}  // namespace conav::nhpm
