#include "planner/search/search_options.h"

#include "common/runtime/config.h"

namespace conav::planner {
namespace {

/// Reads an enumeration by the names of its values, in their order.
template <class Enum>
void EnumField(ConfigReader& reader, const std::string& key, Enum& value,
               const std::vector<std::string>& names) {
  std::string name = names[static_cast<std::size_t>(value)];
  reader.Choice(key, name, names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) value = static_cast<Enum>(i);
  }
}

}  // namespace

void SearchOptions::Visit(ConfigReader& reader) {
  reader.Field("iterations", iterations, 1, 1'000'000);
  reader.Field("time_budget_ms", time_budget_ms, 0.0, 60'000.0);
  reader.Field("trees", trees, 1, 256);
  reader.Field("tree_threads", tree_threads, 1, 256);
  reader.Field("exploration_constant", exploration_constant, 0.0, 1e6);
  reader.Field("discount", discount, 0.0, 1.0);
  reader.Field("rollout_depth", rollout_depth, 1, 10'000);
  EnumField(reader, "tree_reuse", tree_reuse, {"none", "pruned"});
  reader.Field("offers_sent_views", offers_sent_views);
  reader.Field("optional_pictures", optional_pictures);
  reader.Field("min_information", min_information, 0.0, 1e6);
  reader.Section("reward", reward);
  EnumField(reader, "report", report, {"actions", "terms", "tree"});
}

}  // namespace conav::planner
