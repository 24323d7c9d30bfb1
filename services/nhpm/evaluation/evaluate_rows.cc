#include "nhpm/evaluation/evaluate_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/cli/cli.h"
#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/annotators.h"
#include "nhpm/dataset/synthesize.h"
#include "nhpm/model/encoding.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/perception_network.h"

namespace conav::nhpm {
namespace {

void Append(const SegmentSet& from, SegmentSet& to) {
  to.trajectories.insert(to.trajectories.end(), from.trajectories.begin(), from.trajectories.end());
}

Result<void> CheckTestPart(const EvaluateArguments& arguments, const EvaluationData& data) {
  if (SegmentCount(data.test) > 0) return {};
  const std::size_t trajectories = data.train.trajectories.size();
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: nothing is left for the test of its {} {}; --all-test takes the whole file",
                  arguments.data.string(), trajectories,
                  trajectories == 1 ? "trajectory" : "trajectories"));
}

std::string Value(const NetworkModel& model, const char* name) {
  const auto found = model.training.find(name);
  return found == model.training.end() ? "" : found->second;
}

/// What to do about weights that learned from the test part.
std::string Remedy(const NetworkModel& model, const EvaluationData& data) {
  const bool adapted = !Value(model, "adapt_data_sha256").empty();
  if (!adapted && Value(model, "data_sha256") == data.checksum) {
    return "pass --split-seed " + Value(model, "split_seed");
  }
  return "pass data that it never saw (for synthetic people, use another --seed)";
}

/// A network and the name of its row.
struct NamedNetwork {
  RowLabel label;
  NetworkModel model;
};

NamedNetwork Named(const NetworkModel& model, const std::filesystem::path& file,
                   std::size_t number) {
  const std::string suffix = number == 0 ? "" : fmt::format("_{}", number + 1);
  const std::string missing = MissingInputs(model.inputs);
  RowLabel label;
  label.key = fmt::format("nhpm{}", suffix);
  label.title = number == 0 ? "NHPM" : fmt::format("NHPM {}", number + 1);
  label.about = fmt::format("{}: {}; trained on {} data{}", file.filename().string(), model.version,
                            model.data_origin, missing.empty() ? "" : ", without " + missing);
  return {label, model};
}

bool Sees(const NetworkModel& model, const std::string& input) {
  InputSelection inputs = model.inputs;
  return InputOf(inputs, input);
}

NamedNetwork Without(const NamedNetwork& whole, const std::string& input) {
  NamedNetwork ablated = whole;
  InputOf(ablated.model.inputs, input) = false;
  ablated.label.key = fmt::format("{}_without_{}", whole.label.key, input);
  ablated.label.title = fmt::format("{} without {}", whole.label.title, input);
  ablated.label.about = fmt::format("the same weights, with input {} zeroed", input);
  return ablated;
}

/// The named files, or the shipped one if it exists.
std::vector<std::filesystem::path> Files(const EvaluateArguments& arguments, const Reporter& warn) {
  if (!arguments.weights.empty()) return arguments.weights;
  const std::filesystem::path shipped = ShippedWeights();
  if (std::filesystem::exists(shipped)) return {shipped};
  warn(fmt::format("no --weights given and none at {}: no NHPM row", shipped.string()));
  return {};
}

Result<ModelRow> RowOf(const NamedNetwork& network, const EvaluationData& data,
                       const Reporter& progress) {
  PerceptionNetwork model(network.model);
  return EvaluateModel(network.label, model, data, [&](std::size_t done, std::size_t total) {
    progress(fmt::format("{}: {} of {} test segments", network.label.title, done, total));
  });
}

constexpr std::size_t kAveragePeople = 100;  // limit for the mean over people

bool IsSynthetic(const Trajectory& trajectory) {
  return trajectory.origin == SegmentOrigin::kSynthetic;
}

ModelIdentity IdentityOf(const char* name, const std::string& version) {
  return {name, version, ""};
}

OracleOptions OptionsOf(const EvaluateArguments& arguments, const Reporter& progress,
                        const char* what) {
  return {.draws = arguments.oracle_draws,
          .threads = arguments.threads,
          .progress = [&progress, what](std::size_t done, std::size_t total) {
            progress(fmt::format("{} {} of {}", what, done, total));
          }};
}

Result<ModelRow> OracleRow(const EvaluateArguments& arguments, const EvaluationData& data,
                           const Reporter& progress) {
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
       fmt::format("the synthetic annotators themselves, {} draws per segment: the best possible "
                   "on average, up to the filter of their trajectories",
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
                            const Reporter& progress) {
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

Result<EvaluationData> LoadEvaluationData(const EvaluateArguments& arguments) {
  auto read = ReadIdentifiedSegments(arguments.data);
  if (!read) return tl::unexpected(read.error());
  EvaluationData data;
  data.file = arguments.data.filename().string();
  data.checksum = read->checksum;
  if (arguments.all_test) {
    data.test = std::move(read->set);
  } else {
    SegmentSplit split = SplitSegments(read->set, arguments.split_seed);
    data.train = std::move(split.train);
    Append(split.validation, data.train);
    data.test = std::move(split.test);
    data.split_seed = arguments.split_seed;
  }
  if (const auto checked = CheckTestPart(arguments, data); !checked) {
    return tl::unexpected(checked.error());
  }
  return data;
}

Result<std::string> CheckUnseen(const NetworkModel& model, const std::filesystem::path& name,
                                const EvaluationData& data, bool allow_seen) {
  if (model.learned_from.empty()) return UnknownLearning(name);
  const std::size_t seen = CountKnown(data.test, model.learned_from);
  if (seen == 0) return std::string();
  const std::string problem = fmt::format("{}: learned from {} of the {} test trajectories",
                                          name.string(), seen, data.test.trajectories.size());
  if (allow_seen) return problem;
  return Fail(ErrorCode::kRefused,
              fmt::format("{}; {}, or --allow-seen", problem, Remedy(model, data)));
}

Result<std::vector<ModelRow>> NetworkRows(const EvaluateArguments& arguments,
                                          const EvaluationData& data, const Reporter& warn,
                                          const Reporter& progress) {
  const std::vector<std::filesystem::path> files = Files(arguments, warn);
  std::vector<ModelRow> rows;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto model = ReadWeightsFile(files[i]);
    if (!model) return tl::unexpected(model.error());
    const auto unseen = CheckUnseen(*model, files[i], data, arguments.allow_seen);
    if (!unseen) return tl::unexpected(unseen.error());
    if (!unseen->empty()) warn(*unseen);
    std::vector<NamedNetwork> networks{Named(*model, files[i], i)};
    for (const std::string& input : arguments.without) {
      if (Sees(*model, input)) {
        networks.push_back(Without(networks.front(), input));
      } else {
        warn(fmt::format("{}: trained without {}; no further row without it", files[i].string(),
                         input));
      }
    }
    for (const NamedNetwork& network : networks) {
      auto row = RowOf(network, data, progress);
      if (!row) {
        return Fail(row.error().code, fmt::format("{}: {}", files[i].string(), row.error().text));
      }
      rows.push_back(std::move(*row));
    }
  }
  return rows;
}

bool HasOracle(const EvaluationData& data) {
  return std::ranges::all_of(data.test.trajectories, IsSynthetic);
}

Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                         const EvaluationData& data, const Reporter& progress) {
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
