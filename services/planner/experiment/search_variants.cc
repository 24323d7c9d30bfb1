#include "planner/experiment/search_variants.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/runtime/result.h"
#include "common/runtime/yaml_file.h"
#include "nhpm/model/load_model.h"

namespace conav::planner {
namespace {

struct VariantKeys {
  SearchVariant& variant;

  void Visit(ConfigReader& reader) {
    reader.Choice("method", variant.method, {"ig-mcts", "greedy"});
    reader.Section("communication", variant.communication);
    variant.config.Visit(reader);
  }
};

/// Not empty.
YAML::Node VariantsIn(const YAML::Node& document, const std::filesystem::path& file) {
  const YAML::Node section = document.IsMap() ? document["search_variants"] : YAML::Node();
  if (!section || !section.IsMap() || section.size() == 0) {
    throw StartupError(file.string() + ": no map search_variants: {NAME: {...}}");
  }
  return section;
}

}  // namespace

std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file) {
  const auto document = ReadYamlFile(file);
  if (!document) throw StartupError(document.error().text);
  std::vector<SearchVariant> variants;
  for (const auto& entry : VariantsIn(*document, file)) {
    SearchVariant variant;
    variant.name = entry.first.Scalar();
    VariantKeys keys{variant};
    ReadConfig(entry.second, file.string() + ": " + variant.name, keys);
    variants.push_back(std::move(variant));
  }
  return variants;
}

std::filesystem::path ShippedVariants() {
  return nhpm::ShippedWeights().parent_path().parent_path() / "config" / "search_variants.yaml";
}

const SearchVariant& FindVariant(const std::vector<SearchVariant>& variants,
                                 const std::string& name, const std::filesystem::path& file) {
  const auto found = std::find_if(variants.begin(), variants.end(),
                                  [&](const SearchVariant& v) { return v.name == name; });
  if (found != variants.end()) return *found;
  std::string names;
  for (const SearchVariant& variant : variants) names += " " + variant.name;
  throw StartupError(fmt::format("no variant {} in {}; there are{}", name, file.string(), names));
}

}  // namespace conav::planner
