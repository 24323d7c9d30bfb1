#include "planner/search/tree_report.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace conav::planner {
namespace {

/// Numbers of the nodes to report, ascending.
std::vector<int> MostVisitedIndices(const SearchTree& tree, std::size_t limit) {
  std::vector<int> nodes(tree.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  if (nodes.size() <= limit) return nodes;
  const auto before = [&](int a, int b) {
    const auto visits_a = tree.node(a).visit_count;
    const auto visits_b = tree.node(b).visit_count;
    return visits_a != visits_b ? visits_a > visits_b : a < b;
  };
  std::nth_element(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(limit), nodes.end(),
                   before);
  nodes.resize(limit);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

ReportedNode DescribeNode(const SearchNode& node, const NavigationGraph& graph) {
  ReportedNode reported;
  reported.target = graph.CellOf(node.vertex);
  if (node.is_communication) {
    reported.kind = CommandKind::kTransmitView;
    reported.heading_rad = graph.HeadingsAt(node.vertex)[static_cast<std::size_t>(node.view)];
  }
  reported.visits = node.visit_count;
  reported.mean_value = node.mean();
  reported.feasibility = node.feasibility;
  return reported;
}

SearchAction Describe(const SearchProblem& problem, const Actions& actions, int action) {
  SearchAction described;
  if (actions.IsMove(action)) {
    const Edge& edge = actions.MoveOf(action);
    described.kind = CommandKind::kMove;
    described.target = problem.graph.CellOf(edge.target);
    described.feasibility = edge.feasibility;
  } else {
    const int view = actions.views[actions.ViewOf(action)];
    described.kind = CommandKind::kTransmitView;
    described.target = problem.graph.CellOf(problem.start);
    described.heading_rad = problem.graph.HeadingsAt(problem.start)[static_cast<std::size_t>(view)];
  }
  return described;
}

/// The child that `action` leads to; -1 when it was not tried.
int ChildOfRoot(const SearchTree& tree, int action) {
  int child = tree.node(SearchTree::kRoot).first_child;
  while (child >= 0 && tree.node(child).action != action) child = tree.node(child).next_sibling;
  return child;
}

void AddAction(const SearchAction& of_tree, SearchAction& sum) {
  if (of_tree.visits == 0) return;
  const double total_return = sum.mean_value * sum.visits + of_tree.mean_value * of_tree.visits;
  RewardTerms terms = static_cast<double>(sum.visits) * sum.terms;
  terms += static_cast<double>(of_tree.visits) * of_tree.terms;
  sum.visits += of_tree.visits;
  sum.terms = 1.0 / sum.visits * terms;
  sum.mean_value = total_return / sum.visits;
  sum.information_gain = std::max(sum.information_gain, of_tree.information_gain);
}

void AddTree(const SearchResult& tree, SearchResult& sum) {
  for (std::size_t i = 0; i < tree.actions.size(); ++i) AddAction(tree.actions[i], sum.actions[i]);
  sum.views.insert(sum.views.end(), tree.views.begin(), tree.views.end());
  sum.iterations += tree.iterations;
  sum.nodes += tree.nodes;
  sum.perception_queries += tree.perception_queries;
  sum.perception_calls += tree.perception_calls;
  sum.perception_cached += tree.perception_cached;
}

/// As SearchTree::MostVisitedChild (A27); -1 when none was visited.
int MostVisited(std::span<const SearchAction> actions) {
  const auto best = std::ranges::max_element(actions, {}, [](const SearchAction& action) {
    return std::pair(action.visits, action.mean_value);
  });
  return best == actions.end() || best->visits == 0 ? -1 : static_cast<int>(best - actions.begin());
}

}  // namespace

SearchResult ReportTree(const SearchTree& tree, const SearchProblem& problem,
                        OfferedActions& offered, const ViewInformation& information,
                        const PathState& path, SearchDetail detail) {
  SearchResult result;
  const Actions actions = offered.At(problem.start);
  for (int action = 0; action < actions.size(); ++action) {
    SearchAction described = Describe(problem, actions, action);
    if (!actions.IsMove(action)) {
      // Also of a view that was withheld.
      described.information_gain = information.Known(path, actions.ViewOf(action)).value_or(0.0);
    }
    result.actions.push_back(described);
  }
  const SearchNode& root = tree.node(SearchTree::kRoot);
  for (int child = root.first_child; child >= 0; child = tree.node(child).next_sibling) {
    const SearchNode& node = tree.node(child);
    SearchAction& action = result.actions[static_cast<std::size_t>(node.action)];
    action.visits = node.visit_count;
    action.mean_value = node.mean();
    action.information_gain = node.information;
    action.terms = tree.MeanTerms(child);
  }
  result.has_terms = tree.keeps_terms();
  const int chosen = tree.MostVisitedChild(SearchTree::kRoot);
  if (chosen >= 0) result.chosen = tree.node(chosen).action;
  result.nodes = static_cast<std::uint32_t>(tree.size());
  result.perception_queries = information.counts().queries;
  result.perception_calls = information.counts().calls;
  result.perception_cached = information.counts().cached;
  result.expected_path = ExpectedPath(tree, problem.graph);
  if (detail == SearchDetail::kTree) {
    result.tree = MostVisitedNodes(tree, problem.graph, kMaxReportedNodes);
    result.views = information.Asked(kMaxReportedViews);
  }
  return result;
}

std::vector<Cell> ExpectedPath(const SearchTree& tree, const NavigationGraph& graph,
                               std::optional<int> action) {
  std::vector<Cell> cells;
  int node = action ? ChildOfRoot(tree, *action) : tree.MostVisitedChild(SearchTree::kRoot);
  while (node >= 0 && !tree.node(node).is_communication) {
    cells.push_back(graph.CellOf(tree.node(node).vertex));
    node = tree.MostVisitedChild(node);
  }
  return cells;
}

std::vector<ReportedNode> MostVisitedNodes(const SearchTree& tree, const NavigationGraph& graph,
                                           std::size_t limit) {
  const std::vector<int> nodes = MostVisitedIndices(tree, limit);
  std::vector<ReportedNode> reported;
  reported.reserve(nodes.size());
  for (const int index : nodes) {
    reported.push_back(DescribeNode(tree.node(index), graph));
    const auto parent = std::lower_bound(nodes.begin(), nodes.end(), tree.node(index).parent);
    if (tree.node(index).parent >= 0) {
      reported.back().parent = static_cast<int>(parent - nodes.begin());
    }
  }
  return reported;
}

SearchResult SumOfTrees(std::span<const SearchResult> trees) {
  SearchResult sum = trees.front();
  for (const SearchResult& tree : trees.subspan(1)) AddTree(tree, sum);
  sum.views = MostOfEach(std::move(sum.views), kMaxReportedViews);
  sum.tree.clear();
  sum.expected_path.clear();
  sum.chosen = MostVisited(sum.actions);
  return sum;
}

std::size_t TreeWithMostVisits(std::span<const SearchResult> trees, std::size_t action) {
  const auto visits = [&](std::size_t tree) {
    return action < trees[tree].actions.size() ? trees[tree].actions[action].visits : 0;
  };
  std::size_t best = 0;
  for (std::size_t tree = 1; tree < trees.size(); ++tree) {
    if (visits(tree) > visits(best)) best = tree;
  }
  return best;
}

}  // namespace conav::planner
