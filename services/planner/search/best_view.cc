#include "planner/search/best_view.h"

#include "planner/search/path_state.h"
#include "planner/search/view_information.h"

namespace conav::planner {

Result<std::optional<BestView>> FindBestView(const SearchProblem& problem, PerceptionModel& model) {
  const PathState path(problem);
  const OfferedActions offered(problem);
  ViewInformation information(problem, offered, model);
  if (auto asked = information.AskAll(path); !asked) return tl::unexpected(asked.error());
  const auto views = offered.At(problem.start).views;
  const auto headings = problem.graph.HeadingsAt(problem.start);
  std::optional<BestView> best;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto edits = information.Of(path, i);
    if (!edits) return tl::unexpected(edits.error());
    if (best && *edits <= best->information) continue;
    best = {headings[static_cast<std::size_t>(views[i])], *edits, static_cast<int>(views.size())};
  }
  return best;
}

}  // namespace conav::planner
