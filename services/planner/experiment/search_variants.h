#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/decision/search_config.h"

namespace conav::planner {

/// A way to set up the search that an experiment compares with others.
struct SearchVariant {
  std::string name;
  SearchConfig config;
};

/// Reads a YAML map `search_variants: {NAME: {keys of planner.search}, ...}`, in the order of the
/// file. An empty map is the default preset.
/// Throws StartupError that names the file, the variant, the key and the limit.
std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file);

}  // namespace conav::planner
