#include "planner/search/search_options.h"

#include "common/runtime/config.h"

namespace conav::planner {

void SearchOptions::Visit(ConfigReader& reader) {
  reader.Field("iterations", iterations, 1, 1'000'000);
  reader.Field("time_budget_ms", time_budget_ms, 0.0, 60'000.0);
  reader.Field("trees", trees, 1, 256);
  reader.Field("tree_threads", tree_threads, 1, 256);
  reader.Field("exploration_constant", exploration_constant, 0.0, 1e6);
  reader.Field("discount", discount, 0.0, 1.0);
  reader.Field("rollout_depth", rollout_depth, 1, 10'000);
  reader.Choice("tree_reuse", tree_reuse, kTreeReuses);
  reader.Field("offers_sent_views", offers_sent_views);
  reader.Field("optional_pictures", optional_pictures);
  reader.Field("min_information", min_information, 0.0, 1e6);
  reader.Section("reward", reward);
  reader.Choice("report", report, kSearchDetails);
}

}  // namespace conav::planner
