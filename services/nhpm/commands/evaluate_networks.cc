#include <fmt/format.h>

#include "nhpm/commands/evaluate_rows.h"
#include "nhpm/model/input_names.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/perception_network.h"

namespace conav::nhpm {
namespace {

/// A network to be asked, and what its row is called.
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
  ablated.label.about = fmt::format("the same weights, {} zeroed when asked", input);
  return ablated;
}

/// The files that were named; else the shipped one, if it is there.
std::vector<std::filesystem::path> Files(const EvaluateArguments& arguments, const Teller& warn) {
  if (!arguments.weights.empty()) return arguments.weights;
  const std::filesystem::path shipped = ShippedWeights();
  if (std::filesystem::exists(shipped)) return {shipped};
  warn(fmt::format("no --weights given and none at {}: no NHPM row", shipped.string()));
  return {};
}

Result<ModelRow> RowOf(const NamedNetwork& network, const EvaluationData& data,
                       const Teller& progress) {
  return EvaluateModel(
      network.label, PerceptionNetwork(network.model), data,
      [&](std::size_t done, std::size_t total) {
        progress(fmt::format("{}: {} of {} test segments", network.label.title, done, total));
      });
}

}  // namespace

Result<std::vector<ModelRow>> NetworkRows(const EvaluateArguments& arguments,
                                          const EvaluationData& data, const Teller& warn,
                                          const Teller& progress) {
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
        warn(fmt::format("{}: was trained without {}: no further row without it", files[i].string(),
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

}  // namespace conav::nhpm
