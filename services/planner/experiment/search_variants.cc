#include "planner/experiment/search_variants.h"

#include "common/runtime/result.h"

namespace conav::planner {

std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file) {
  YAML::Node document;
  try {
    document = YAML::LoadFile(file.string());
  } catch (const YAML::Exception& error) {
    throw StartupError(file.string() + ": " + error.what());
  }
  const YAML::Node section = document["search_variants"];
  if (!section || !section.IsMap() || section.size() == 0) {
    throw StartupError(file.string() + ": no map search_variants: {NAME: {...}}");
  }
  std::vector<SearchVariant> variants;
  for (const auto& entry : section) {
    SearchVariant variant{entry.first.as<std::string>(), {}};
    ReadConfig(entry.second, file.string() + ": " + variant.name, variant.config);
    variants.push_back(std::move(variant));
  }
  return variants;
}

}  // namespace conav::planner
