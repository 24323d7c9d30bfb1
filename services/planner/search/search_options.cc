#include "planner/search/search_options.h"

#include <cmath>

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
  EnumField(reader, "expansion", expansion, {"single", "chain"});
  reader.Field("chain_depth", chain_depth, 1, 10'000);
  EnumField(reader, "untried_order", untried_order, {"moves_first", "random"});
  EnumField(reader, "backup", backup, {"propagated_sample", "rollout_return"});
  reader.Field("selection_uses_feasibility", selection_uses_feasibility);
  reader.Field("guidance_prior", guidance_prior, 0.0, 1e6);
  EnumField(reader, "tree_reuse", tree_reuse, {"none", "unchanged", "pruned"});
  EnumField(reader, "view_questions", view_questions, {"single", "place"});
  reader.Field("offers_sent_views", offers_sent_views);
  reader.Field("optional_pictures", optional_pictures);
  reader.Field("min_information", min_information, 0.0, 1e6);
  reader.Field("rollout_communication_probability", rollout_communication_probability, -1.0, 1.0);
  reader.Section("reward", reward);
  EnumField(reader, "report", report, {"actions", "terms", "tree"});
}

SearchOptions PaperOptions() {
  SearchOptions options;
  options.iterations = 100;
  options.exploration_constant = std::sqrt(2.0);
  options.untried_order = UntriedOrder::kMovesFirst;
  options.offers_sent_views = true;
  options.optional_pictures = false;
  options.min_information = 0.0;
  options.reward.communication_cost = 10.0;
  options.reward.view_turn = 0.0;
  options.reward.progress = 0.0;
  return options;
}

}  // namespace conav::planner
