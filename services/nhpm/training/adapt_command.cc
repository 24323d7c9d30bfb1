#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/adapt.h"
#include "nhpm/training/batch_pass.h"
#include "nhpm/training/example.h"
#include "nhpm/training/train_command.h"

namespace conav::nhpm {
namespace {

constexpr const char* kProgramName = "conav train";

/// A base network and matching data.
struct Inputs {
  NetworkModel base;
  SegmentSet set;
  std::string data_checksum;
  SegmentSet general;  // of --general
};

Error Named(const std::filesystem::path& path, const Error& error) {
  return {error.code, fmt::format("{}: {}", path.string(), error.text)};
}

Result<void> CheckFits(const NetworkModel& base, const SegmentSet& set) {
  if (SegmentCount(set) == 0) return Fail(ErrorCode::kInvalidArgument, "has no segments");
  if (const auto checked = CheckOneSize(set); !checked) return checked;
  const BeliefGrid& belief = AllSegments(set).front()->query.belief;
  if (base.rows == 0 || (base.rows == belief.rows() && base.columns == belief.columns())) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("has maps of {} x {} cells; the base is for {} x {}", belief.rows(),
                          belief.columns(), base.rows, base.columns));
}

Result<Inputs> Load(const AdaptArguments& arguments) {
  auto base = ReadWeightsFile(arguments.base);
  if (!base) return tl::unexpected(base.error());
  if (base->weights.shape.architecture != Architecture::kConvolutional) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is an encoder-decoder; only model nhpm adapts to a person",
                            arguments.base.string()));
  }
  auto data = ReadIdentifiedSegments(arguments.data);
  if (!data) return tl::unexpected(data.error());
  if (const auto checked = CheckFits(*base, data->set); !checked) {
    return tl::unexpected(Named(arguments.data, checked.error()));
  }
  Inputs inputs{std::move(*base), std::move(data->set), std::move(data->checksum), {}};
  if (arguments.general.empty()) return inputs;
  auto general = ReadSegmentFile(arguments.general);
  if (!general) return tl::unexpected(general.error());
  if (const auto checked = CheckFits(inputs.base, *general); !checked) {
    return tl::unexpected(Named(arguments.general, checked.error()));
  }
  if (const std::size_t seen = CountKnown(*general, inputs.base.learned_from); seen > 0) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format("{}: learned from {} of the {} trajectories of {}", arguments.base.string(),
                    seen, general->trajectories.size(), arguments.general.string()));
  }
  inputs.general = *std::move(general);
  return inputs;
}

std::string JoinedOrigins(const std::string& base, const std::string& person) {
  return base == person || base.empty() ? person : base + "+" + person;
}

/// kAdaptSettings.
std::map<std::string, std::string> SettingsOf(const AdaptArguments& arguments, const Inputs& inputs,
                                              const Person& person) {
  return {{"base_checksum", ChecksumOf(inputs.base)},
          {"adapt_participant", person.participant},
          {"adapt_data_sha256", inputs.data_checksum},
          {"adapt_seed", fmt::format("{}", arguments.seed)}};
}

NetworkModel AdaptedModel(const AdaptArguments& arguments, const Inputs& inputs,
                          const Person& person, const Adaptation& adaptation) {
  NetworkModel model = inputs.base;
  model.version = fmt::format("{}, adapted to {}", inputs.base.version, person.participant);
  model.weights = adaptation.weights;
  model.data_origin = JoinedOrigins(inputs.base.data_origin, OriginText(person.set));
  if (!inputs.base.learned_from.empty()) {  // an unknown base stays unknown
    model.learned_from = Union(inputs.base.learned_from, FingerprintsOf(person.set));
  }
  for (const auto& [name, value] : SettingsOf(arguments, inputs, person)) {
    model.training[name] = value;
  }
  model.training["adapt_segments"] = fmt::format("{}", SegmentCount(person.set));
  model.training["adapt_pull"] = fmt::format("{}", adaptation.pull);
  model.training["adapt_epochs"] = fmt::format("{}", adaptation.epochs);
  model.training["adapt_base_mbce"] = fmt::format("{:.8f}", adaptation.base_loss);
  model.training["adapt_held_out_mbce"] = fmt::format("{:.8f}", adaptation.held_out_loss);
  return model;
}

double Percent(double base, double adapted) { return 100.0 * (adapted - base) / base; }

std::string SummaryText(const AdaptArguments& arguments, const Person& person,
                        const Adaptation& adaptation, const NetworkModel& model) {
  return fmt::format(
      "adapted to  {} ({}): {} segments, {} epochs, pull {}{}\n"
      "held out    MBCE {:.5f} with the base, {:.5f} adapted ({:+.1f} %)\n"
      "weights     {}  SHA-256 {}\n",
      person.participant, OriginText(person.set), SegmentCount(person.set), adaptation.epochs,
      adaptation.pull,
      adaptation.epochs > 0   ? ""
      : adaptation.calibrated ? ": calibrated only"
                              : ": the base was best",
      adaptation.base_loss, adaptation.held_out_loss,
      Percent(adaptation.base_loss, adaptation.held_out_loss), arguments.out.string(),
      ChecksumOf(model));
}

/// Adapts to one person.
Result<void> AdaptToOne(const AdaptArguments& arguments, const Inputs& inputs,
                        const StopToken& stop) {
  const auto person = FindPerson(PeopleOf(inputs.set), arguments.participant);
  if (!person) return tl::unexpected(Named(arguments.data, person.error()));
  if (!arguments.overwrite) {
    const auto replaceable =
        CheckReplaceable(arguments.out, SettingsOf(arguments, inputs, *person));
    if (!replaceable) return replaceable;
  }
  AdaptOptions options;
  options.seed = arguments.seed;
  const auto adaptation =
      Adapt(inputs.base.weights, AdaptationGroups(person->set, inputs.base.inputs), options,
            arguments.threads, stop);
  if (!adaptation) return tl::unexpected(adaptation.error());
  const NetworkModel model = AdaptedModel(arguments, inputs, *person, *adaptation);
  if (const auto written = WriteWeightsFile(arguments.out, model); !written) return written;
  const auto printed =
      arguments.json == "-"
          ? Result<void>()
          : WriteStandardOutput(SummaryText(arguments, *person, *adaptation, model));
  if (!printed) return printed;
  return WriteJsonOutput(arguments.json, {{"weights", arguments.out.string()},
                                          {"checksum", ChecksumOf(model)},
                                          {"data_origin", model.data_origin},
                                          {"training", model.training},
                                          {"base_mbce", adaptation->base_loss},
                                          {"held_out_mbce", adaptation->held_out_loss}});
}

/// The gain from half of a person's trajectories on the other half.
struct PersonResult {
  std::string participant;
  std::string origin;
  std::size_t learned_from = 0;  // segments
  std::size_t tested_on = 0;
  Adaptation adaptation;
  double base_loss = 0.0;  // on the other half
  double adapted_loss = 0.0;
  double base_general_loss = 0.0;  // on everybody's segments, if given
  double adapted_general_loss = 0.0;
};

/// Losses of several weights on one set.
class Losses {
 public:
  Losses(const NetworkModel& base, const SegmentSet& set, int threads)
      : set_(ExamplesOf(set, base.inputs)),
        pass_(base.weights.shape, set_.rows, set_.columns, threads) {}
  double Of(const NetworkWeights& weights) {
    return pass_.MeanLoss(TrainingWeights(weights), set_.examples);
  }

 private:
  ExampleSet set_;
  BatchPass pass_;
};

/// Tests on every second trajectory. Empty for a person with only one.
Result<std::optional<PersonResult>> MeasurePerson(const AdaptArguments& arguments,
                                                  const Inputs& inputs, const Person& person,
                                                  const StopToken& stop) {
  const NetworkModel& base = inputs.base;
  SegmentSet learned;
  SegmentSet tested;
  for (std::size_t i = 0; i < person.set.trajectories.size(); ++i) {
    (i % 2 == 0 ? learned : tested).trajectories.push_back(person.set.trajectories[i]);
  }
  if (SegmentCount(learned) < 2 || SegmentCount(tested) == 0) return std::nullopt;
  const std::size_t seen = CountKnown(tested, base.learned_from);
  if (seen > 0) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format(
            "{}: learned from {} of the {} test trajectories of {}; pass data that it never saw",
            arguments.base.string(), seen, tested.trajectories.size(), person.participant));
  }
  AdaptOptions options;
  options.seed = arguments.seed;
  auto adaptation =
      Adapt(base.weights, AdaptationGroups(learned, base.inputs), options, arguments.threads, stop);
  if (!adaptation) return tl::unexpected(adaptation.error());
  Losses own(base, tested, arguments.threads);
  PersonResult result{person.participant, OriginText(person.set), SegmentCount(learned),
                      SegmentCount(tested), std::move(*adaptation)};
  result.base_loss = own.Of(base.weights);
  result.adapted_loss = own.Of(result.adaptation.weights);
  if (inputs.general.trajectories.empty()) return result;
  Losses general(base, inputs.general, arguments.threads);
  result.base_general_loss = general.Of(base.weights);
  result.adapted_general_loss = general.Of(result.adaptation.weights);
  return result;
}

std::string Table(const std::vector<PersonResult>& results) {
  std::string text =
      fmt::format("{:<16} {:<10} {:>12} {:>10} {:>6} {:>8}  {:>10} {:>12} {:>8} {:>13}\n",
                  "participant", "edits", "learned from", "tested on", "epochs", "pull",
                  "base MBCE", "adapted MBCE", "change", "on everybody");
  for (const PersonResult& r : results) {
    text += fmt::format(
        "{:<16} {:<10} {:>12} {:>10} {:>6} {:>8}  {:>10.5f} {:>12.5f} {:>+7.1f}% {:>13}\n",
        r.participant, r.origin, r.learned_from, r.tested_on, r.adaptation.epochs,
        r.adaptation.pull, r.base_loss, r.adapted_loss, Percent(r.base_loss, r.adapted_loss),
        r.base_general_loss == 0.0
            ? "-"
            : fmt::format("{:+.1f}%", Percent(r.base_general_loss, r.adapted_general_loss)));
  }
  return text;
}

nlohmann::ordered_json ToJson(const std::vector<PersonResult>& results) {
  auto people = nlohmann::ordered_json::array();
  for (const PersonResult& r : results) {
    nlohmann::ordered_json person{{"participant", r.participant},
                                  {"data_origin", r.origin},
                                  {"learned_from_segments", r.learned_from},
                                  {"tested_on_segments", r.tested_on},
                                  {"epochs", r.adaptation.epochs},
                                  {"pull", r.adaptation.pull},
                                  {"base_mbce", r.base_loss},
                                  {"adapted_mbce", r.adapted_loss}};
    if (r.base_general_loss > 0.0) {
      person["base_general_mbce"] = r.base_general_loss;
      person["adapted_general_mbce"] = r.adapted_general_loss;
    }
    people.push_back(std::move(person));
  }
  return {{"people", people}};
}

Result<void> AdaptToEach(const AdaptArguments& arguments, const Inputs& inputs,
                         const StopToken& stop) {
  const std::vector<Person> people = PeopleOf(inputs.set);
  std::vector<PersonResult> results;
  if (inputs.base.learned_from.empty()) Warn(kProgramName, UnknownLearning(arguments.base));
  {
    ProgressLine progress;
    for (const Person& person : people) {
      auto result = MeasurePerson(arguments, inputs, person, stop);
      if (!result) return tl::unexpected(result.error());
      if (result->has_value()) results.push_back(std::move(**result));
      progress.Show(fmt::format("adapted to {} of {} participants", results.size(), people.size()));
    }
  }
  if (results.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no participant with two trajectories", arguments.data.string()));
  }
  const auto printed = arguments.json == "-" ? Result<void>() : WriteStandardOutput(Table(results));
  if (!printed) return printed;
  return WriteJsonOutput(arguments.json, ToJson(results));
}

}  // namespace

int RunAdapt(const AdaptArguments& arguments, const StopToken& stop) {
  const int code = CheckFiles(
      kProgramName,
      {{"--data", arguments.data}, {"--base", arguments.base}, {"--general", arguments.general}},
      {{"--out", arguments.out}, {"--json", arguments.json}});
  if (code != 0) return code;
  const auto inputs = Load(arguments);
  if (!inputs) return Failed(kProgramName, inputs.error());
  return ExitCode(kProgramName, arguments.each ? AdaptToEach(arguments, *inputs, stop)
                                               : AdaptToOne(arguments, *inputs, stop));
}

}  // namespace conav::nhpm
