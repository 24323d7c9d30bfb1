#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/decision/method_config.h"

namespace conav::planner {

/// A way to set up the search that an experiment compares with others.
struct SearchVariant {
  std::string name;
  SearchConfig config;
  CommunicationConfig communication;
  std::string method = "ig-mcts";  // or "greedy"
};

/// Reads a YAML map `search_variants: {NAME: {keys of planner.search}, ...}`, in the order of the
/// file; beside them a variant may have `communication: {keys of planner.communication}` and
/// `method`. An empty map is the default preset.
/// Throws StartupError that names the file, the variant, the key and the limit.
std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file);

/// The variants that come with conav.
std::filesystem::path ShippedVariants();

/// The one called `name`. Throws StartupError that names `file` and what there is.
const SearchVariant& FindVariant(const std::vector<SearchVariant>& variants,
                                 const std::string& name, const std::filesystem::path& file);

}  // namespace conav::planner
