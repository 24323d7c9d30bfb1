#include "planner/search/best_view.h"

#include "planner/search/path_state.h"
#include "planner/search/reward.h"
#include "planner/search/view_information.h"

namespace conav::planner {

Result<std::optional<BestView>> FindBestView(const SearchProblem& problem, PerceptionModel& model,
                                             double least_information, double turn_cost) {
  const PathState path(problem);
  const OfferedActions offered(problem);
  ViewInformation information(problem, offered, model);
  if (auto asked = information.AskAll(path); !asked) return tl::unexpected(asked.error());
  const auto views = offered.At(problem.start).views;
  const auto headings = problem.graph.HeadingsAt(problem.start);
  RewardOptions turns;
  turns.view_turn = turn_cost;
  std::optional<BestView> best;
  double best_value = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto edits = information.Of(path, i);
    if (!edits) return tl::unexpected(edits.error());
    const double heading_rad = headings[static_cast<std::size_t>(views[i])];
    const double value = *edits - TurnCost(path, heading_rad, turns);
    if (*edits < least_information || (best && value <= best_value)) continue;
    best_value = value;
    best = {heading_rad, *edits, static_cast<int>(views.size())};
  }
  return best;
}

}  // namespace conav::planner
