#include "planner/search/tree_reuse.h"

#include <algorithm>
#include <utility>

namespace conav::planner {
namespace {

std::vector<Cell> PathToStart(const SearchProblem& problem) {
  std::vector<Cell> path = problem.path;
  const Cell start = problem.graph.CellOf(problem.start);
  if (path.empty() || path.back() != start) path.push_back(start);
  return path;
}

/// The child of the root that is a move to `start` and was searched further; -1 if there is none.
int BranchTo(const SearchTree& tree, VertexId start) {
  const SearchNode& root = tree.node(SearchTree::kRoot);
  for (int child = root.first_child; child >= 0; child = tree.node(child).next_sibling) {
    const SearchNode& node = tree.node(child);
    if (!node.is_communication && node.vertex == start) return node.is_terminal ? -1 : child;
  }
  return -1;
}

/// The number that `node`'s action has among `actions`; -1 when it is not offered any more.
int ActionOf(const SearchNode& node, const Actions& actions) {
  if (node.is_communication) {
    const auto found = std::find(actions.views.begin(), actions.views.end(), node.view);
    if (found == actions.views.end()) return -1;
    return static_cast<int>(actions.moves.size() +
                            static_cast<std::size_t>(found - actions.views.begin()));
  }
  const auto found = std::find_if(actions.moves.begin(), actions.moves.end(),
                                  [&](const Edge& edge) { return edge.target == node.vertex; });
  return found == actions.moves.end() ? -1 : static_cast<int>(found - actions.moves.begin());
}

/// Copies what is below `from` in `tree` to below `to` in `branch`, where it is still offered
/// and, at the root, worth it.
void CopyChildren(const SearchTree& tree, int from, OfferedActions& offered,
                  const SearchOptions& options, int to, SearchTree& branch) {
  const Actions actions = offered.At(branch.node(to).vertex);
  for (int child = tree.node(from).first_child; child >= 0; child = tree.node(child).next_sibling) {
    SearchNode node = tree.node(child);
    node.action = ActionOf(node, actions);
    if (node.action < 0) continue;
    const bool may_be_sent =
        to != SearchTree::kRoot || IsWorthSending(node.information, node.reward, options);
    if (node.is_communication && !may_be_sent) continue;
    if (actions.IsMove(node.action) && actions.MoveOf(node.action).feasibility >= 1.0) {
      node.feasibility = 1.0;
    }
    node.parent = to;
    node.first_child = node.last_child = node.next_sibling = -1;
    node.tried = 0;
    const int copy = branch.Add(node, tree.keeps_terms() ? tree.terms(child) : NodeTerms{});
    CopyChildren(tree, child, offered, options, copy, branch);
  }
}

}  // namespace

void SearchMemory::Keep(const SearchProblem& problem, SearchTree tree) {
  kept_.emplace(Kept{std::move(tree), PathToStart(problem), problem.goals_left, problem.guidance,
                     problem.guided_before, problem.belief, problem.information_weight,
                     problem.answer_value});
}

std::optional<SearchTree> SearchMemory::BranchFor(const SearchProblem& problem,
                                                  OfferedActions& offered,
                                                  const SearchOptions& options) const {
  if (!kept_ || options.tree_reuse == TreeReuse::kNone) return std::nullopt;
  std::vector<Cell> path = kept_->path;
  path.push_back(problem.graph.CellOf(problem.start));
  const bool same =
      kept_->goals_left == problem.goals_left && kept_->guidance == problem.guidance &&
      kept_->guided_before == problem.guided_before && *kept_->belief == *problem.belief &&
      kept_->information_weight == problem.information_weight &&
      kept_->answer_value == problem.answer_value && path == PathToStart(problem);
  if (!same) return std::nullopt;
  const int from = BranchTo(kept_->tree, problem.start);
  if (from < 0) return std::nullopt;
  const SearchNode& old = kept_->tree.node(from);
  SearchTree branch(problem.start, NodesExpected(options) + kept_->tree.size(),
                    kept_->tree.keeps_terms());
  // Entering the root gives no reward.
  branch.SetRootVisits(old.visit_count, old.total_return - old.visit_count * old.reward);
  if (branch.keeps_terms()) {
    RewardTerms total = kept_->tree.terms(from).total;
    total += -1.0 * old.visit_count * kept_->tree.terms(from).reward;
    branch.SetRootTerms(total);
  }
  CopyChildren(kept_->tree, from, offered, options, SearchTree::kRoot, branch);
  return branch;
}

}  // namespace conav::planner
