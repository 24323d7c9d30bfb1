#include "nhpm/dataset/annotators.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/runtime/config.h"

namespace conav::nhpm {
namespace {

struct SpreadField {
  const char* name;
  ParameterSpread AnnotatorKind::*spread;
  double low;
  double high;
};

/// The parameters of a SnapshotReader with the ends of their ranges, in the order of the draws.
constexpr std::array<SpreadField, 13> kReaderFields{{
    {"edit_probability", &AnnotatorKind::edit_probability, 0.0, 1.0},
    {"decay_cells", &AnnotatorKind::decay_cells, 0.1, 1e6},
    {"path_removal_probability", &AnnotatorKind::path_removal_probability, 0.0, 1.0},
    {"far_centre_probability", &AnnotatorKind::far_centre_probability, 0.0, 1.0},
    {"far_cells", &AnnotatorKind::far_cells, 0.0, 1e6},
    {"centre_deg", &AnnotatorKind::centre_deg, 0.0, 180.0},
    {"lateral_factor", &AnnotatorKind::lateral_factor, 0.0, 1.0},
    {"lateral_deg", &AnnotatorKind::lateral_deg, 0.0, 180.0},
    {"misplacement_probability", &AnnotatorKind::misplacement_probability, 0.0, 1.0},
    {"near_cells", &AnnotatorKind::near_cells, 0.0, 1e6},
    {"lapse_probability", &AnnotatorKind::lapse_probability, 0.0, 1.0},
    {"guess_probability", &AnnotatorKind::guess_probability, 0.0, 1.0},
    {"edit_limit", &AnnotatorKind::edit_limit, 0.0, 1000.0},
}};
/// Of other mechanisms than "paper", drawn last.
constexpr std::array<SpreadField, 2> kMechanismFields{{
    {"rate", &AnnotatorKind::rate, 0.0, 1.0},
    {"amount", &AnnotatorKind::amount, -1.0, 1000.0},
}};
constexpr const char* kMechanism = "mechanism";
constexpr SpreadField kExtraPictures{"extra_pictures", &AnnotatorKind::extra_pictures, 0.0, 1000.0};

/// A ParameterSpread in a file, whose mean must be in the parameter's range.
struct RangedSpread {
  ParameterSpread& spread;
  double low;
  double high;

  void Visit(ConfigReader& reader) {
    reader.Field("mean", spread.mean, low, high);
    reader.Field("deviation", spread.deviation, 0.0, 1e6);
  }
};

/// Mean 0, variance 1, within +-6: the sum of twelve uniform numbers, without any function of the C
/// library.
double BellShaped(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.Unit();
  return sum;
}

double DrawValue(const AnnotatorKind& kind, const SpreadField& field, Random& random) {
  const ParameterSpread& spread = kind.*field.spread;
  return std::clamp(spread.mean + spread.deviation * BellShaped(random), field.low, field.high);
}

}  // namespace

void AnnotatorKind::Visit(ConfigReader& reader) {
  const auto visit = [&](const SpreadField& field) {
    RangedSpread ranged{this->*field.spread, field.low, field.high};
    reader.Section(field.name, ranged);
  };
  for (const SpreadField& field : kReaderFields) visit(field);
  visit(kExtraPictures);
  reader.Choice(kMechanism, mechanism, operators::kReadingMechanisms);
  for (const SpreadField& field : kMechanismFields) visit(field);
}

AnnotatorKind CarelessKind() {
  AnnotatorKind kind;
  kind.edit_probability = {0.35, 0.15};
  kind.decay_cells = {4.0, 1.0};
  kind.path_removal_probability = {0.5, 0.2};
  kind.far_centre_probability = {0.5, 0.15};
  kind.misplacement_probability = {0.6, 0.15};
  kind.lapse_probability = {0.4, 0.15};
  kind.guess_probability = {0.3, 0.15};
  kind.edit_limit = {3.0, 1.0};
  kind.extra_pictures = {5.0, 3.0};
  return kind;
}

void AnnotatorPopulation::Visit(ConfigReader& reader) {
  reader.Section("careful", careful);
  reader.Section("careless", careless);
  reader.Field("careless_share", careless_share, 0.0, 1.0);
}

AnnotatorPopulation ReadPopulation(const std::filesystem::path& file) {
  AnnotatorPopulation population;
  ReadConfig(LoadParameters(file, "annotators"), file.string() + ": annotators", population);
  return population;
}

Annotator DrawAnnotator(const AnnotatorPopulation& population, Random& random) {
  const AnnotatorKind& kind =
      random.Chance(population.careless_share) ? population.careless : population.careful;
  std::map<std::string, double> values;
  for (const SpreadField& field : kReaderFields) {
    values[field.name] = DrawValue(kind, field, random);
  }
  values["edit_limit"] = std::round(values["edit_limit"]);
  const double extra_pictures = DrawValue(kind, kExtraPictures, random);
  if (kind.mechanism != operators::ReadingMechanism::kPaper) {
    values[kMechanism] = static_cast<double>(kind.mechanism);
    for (const SpreadField& field : kMechanismFields) {
      values[field.name] = DrawValue(kind, field, random);
    }
  }
  const auto reader = FromNamedValues(values);
  DEMAND(reader.has_value());  // the fields name all parameters and their ranges
  return {*reader, static_cast<int>(std::lround(extra_pictures))};
}

std::map<std::string, double> ToNamedValues(operators::SnapshotReaderParameters parameters) {
  ConfigReader writer;
  parameters.Visit(writer);
  std::map<std::string, double> values;
  for (const auto& entry : writer.emitted()) {
    const auto name = entry.first.as<std::string>();
    values[name] =
        name == kMechanism ? static_cast<double>(parameters.mechanism) : entry.second.as<double>();
  }
  if (parameters.mechanism != operators::ReadingMechanism::kPaper) return values;
  for (const char* name : {kMechanism, "rate", "amount"}) values.erase(name);
  return values;
}

Result<operators::SnapshotReaderParameters> FromNamedValues(
    const std::map<std::string, double>& values) {
  operators::SnapshotReaderParameters parameters;
  YAML::Node node(YAML::NodeType::Map);
  for (const auto& [name, value] : ToNamedValues(parameters)) {
    const auto given = values.find(name);
    if (given == values.end()) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("annotator: no value for '{}'", name));
    }
  }
  for (const auto& [name, value] : values) node[name] = value;
  if (const auto given = values.find(kMechanism); given != values.end()) {
    const auto number = static_cast<std::size_t>(std::max(0.0, given->second));
    node[kMechanism] = number < operators::kReadingMechanisms.size()
                           ? std::string(Name(operators::kReadingMechanisms[number]))
                           : fmt::format("{}", number);
  }
  try {
    ReadConfig(node, "annotator", parameters);
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument, error.what());
  }
  return parameters;
}

}  // namespace conav::nhpm
