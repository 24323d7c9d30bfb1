#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/adapt.h"
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
  return Inputs{std::move(*base), std::move(data->set), std::move(data->checksum)};
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

}  // namespace

int RunAdapt(const AdaptArguments& arguments, const StopToken& stop) {
  const int code =
      CheckFiles(kProgramName, {{"--data", arguments.data}, {"--base", arguments.base}},
                 {{"--out", arguments.out}, {"--json", arguments.json}});
  if (code != 0) return code;
  const auto inputs = Load(arguments);
  if (!inputs) return Failed(kProgramName, inputs.error());
  return ExitCode(kProgramName, AdaptToOne(arguments, *inputs, stop));
}

}  // namespace conav::nhpm
