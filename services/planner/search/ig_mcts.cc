#include "planner/search/ig_mcts.h"

#include <algorithm>
#include <bit>

#include "common/runtime/result.h"

namespace conav::planner {
namespace {

/// Nodes that a decision can add, or as many as are worth reserving memory for.
std::size_t NodesExpected(const SearchOptions& options) {
  constexpr std::size_t kMost = 100'000;
  const std::size_t of_iteration =
      options.expansion == Expansion::kSingle ? 1 : static_cast<std::size_t>(options.chain_depth);
  return std::min(kMost, static_cast<std::size_t>(options.iterations) * of_iteration);
}

}  // namespace

TreeSearch::TreeSearch(const SearchOptions& options, const SearchProblem& problem,
                       PerceptionModel& model, Random& random, const SearchMemory* memory)
    : options_(options),
      problem_(problem),
      random_(random),
      path_(problem, options.rollout_depth * 2),
      offered_(problem),
      information_(problem, offered_, model, options.view_questions),
      rollout_(options, path_, offered_, information_, random),
      tree_(problem.start, NodesExpected(options), options.report != SearchDetail::kActions) {
  if (memory == nullptr) return;
  auto branch = memory->BranchFor(problem, offered_, options, NodesExpected(options));
  if (branch && branch->keeps_terms() == tree_.keeps_terms()) tree_ = *std::move(branch);
}

Result<bool> TreeSearch::Start() {
  const Actions actions = offered_.At(problem_.start);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  if (path_.goals_left() == 0 || actions.size() == 0) return false;
  if (options_.min_information <= 0.0 && !options_.optional_pictures) return true;
  if (auto asked = information_.AskAll(path_); !asked) return tl::unexpected(asked.error());
  for (std::size_t view = 0; view < actions.views.size(); ++view) {
    const auto information = information_.Of(path_, view);
    if (!information) return tl::unexpected(information.error());
    const double heading_rad = path_.ViewHeading(actions.views[view]);
    const double reward = CommunicationReward(path_, heading_rad, *information, options_.reward);
    if (IsWorthSending(*information, reward, options_)) continue;
    tree_.Withhold(SearchTree::kRoot, static_cast<int>(actions.moves.size() + view));
  }
  // A root that was taken over has children.
  return tree_.size() > 1 || !IsFullyExpanded(SearchTree::kRoot);
}

Result<void> TreeSearch::Iterate() {
  int node = SearchTree::kRoot;
  int expansions = options_.expansion == Expansion::kSingle ? 1 : options_.chain_depth;
  while (!tree_.node(node).is_terminal && expansions > 0) {
    if (IsFullyExpanded(node)) {
      node = Select(node);  // stage 1
    } else {
      const Result<int> child = Expand(node);  // stage 2
      if (!child) return tl::unexpected(child.error());
      node = *child;
      --expansions;
    }
  }
  const Result<double> rollout_return = Evaluate(node);  // stage 3
  if (rollout_return) Backup(node, *rollout_return);     // stage 4
  path_.TakeBack(0);
  if (!rollout_return) return tl::unexpected(rollout_return.error());
  ++iterations_;
  return {};
}

bool TreeSearch::IsFullyExpanded(int node) {
  const int actions = offered_.At(tree_.node(node).vertex).size();
  const std::uint64_t all =
      actions == kMaxActions ? ~std::uint64_t{0} : (std::uint64_t{1} << actions) - 1;
  return tree_.node(node).tried == all;
}

int TreeSearch::Select(int node) {
  const int child = tree_.SelectChild(node, options_, random_);
  const SearchNode& chosen = tree_.node(child);
  if (!chosen.is_communication) {
    path_.Go(offered_.At(tree_.node(node).vertex).MoveOf(chosen.action));
  }
  return child;
}

Result<int> TreeSearch::Expand(int node) {
  const Actions actions = offered_.At(tree_.node(node).vertex);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  const int action = UntriedAction(actions, tree_.node(node).tried);
  NodeTerms terms;
  if (actions.IsMove(action)) {
    const SearchNode child = Move(node, action, actions.MoveOf(action));
    if (tree_.keeps_terms()) terms.reward = MoveTerms(path_, options_.reward);
    return tree_.Add(child, terms);
  }
  const auto child = Communicate(node, action, actions, terms.reward);
  if (!child) return tl::unexpected(child.error());
  return tree_.Add(*child, terms);
}

Result<double> TreeSearch::Evaluate(int leaf) {
  if (tree_.node(leaf).is_terminal) return 0.0;
  return rollout_.Run(path_);
}

void TreeSearch::Backup(int leaf, double rollout_return) {
  if (tree_.keeps_terms()) {
    const bool rolled_out = !tree_.node(leaf).is_terminal;
    tree_.BackupTerms(leaf, rolled_out ? rollout_.Terms(path_) : RewardTerms{}, options_);
  }
  tree_.Backup(leaf, rollout_return, options_);
}

int TreeSearch::UntriedAction(const Actions& actions, std::uint64_t tried) {
  int left = actions.size() - std::popcount(tried);
  if (options_.untried_order == UntriedOrder::kRandom) {
    left = 1 + static_cast<int>(random_.Uniform(0, left - 1));
  } else {
    left = 1;
  }
  int action = -1;
  while (left > 0) {
    ++action;
    if ((tried >> action & 1U) == 0) --left;
  }
  return action;
}

/// Only the transition that succeeds becomes a node; its probability is kept beside it.
SearchNode TreeSearch::Move(int parent, int action, const Edge& edge) {
  SearchNode child;
  child.parent = parent;
  child.action = action;
  child.vertex = edge.target;
  child.feasibility = path_.IsKnownFree(edge) ? 1.0 : edge.feasibility;
  path_.Go(edge);
  child.is_guided = path_.on_guidance();
  child.reward = MoveReward(path_, options_.reward);
  child.is_terminal = path_.at_goal() || tree_.node(parent).depth + 1 >= options_.rollout_depth ||
                      offered_.At(edge.target).size() == 0;
  return child;
}

/// A picture, or the end of a branch where it would cost more than it tells.
Result<SearchNode> TreeSearch::Communicate(int parent, int action, const Actions& actions,
                                           RewardTerms& terms) {
  const auto information = information_.Of(path_, actions.ViewOf(action));
  if (!information) return tl::unexpected(information.error());
  SearchNode child;
  child.parent = parent;
  child.action = action;
  child.vertex = path_.vertex();
  child.is_communication = true;
  child.is_terminal = true;
  child.view = actions.views[actions.ViewOf(action)];
  const double heading_rad = path_.ViewHeading(child.view);
  const double reward = CommunicationReward(path_, heading_rad, *information, options_.reward);
  const bool may_go_without = options_.optional_pictures && parent != SearchTree::kRoot;
  if (may_go_without && reward < 0.0) return child;
  child.information = *information;
  child.reward = reward;
  if (tree_.keeps_terms()) {
    terms = CommunicationTerms(path_, heading_rad, *information, options_.reward);
  }
  return child;
}

SearchResult TreeSearch::Report() {
  SearchResult result;
  const Actions actions = offered_.At(problem_.start);
  for (int action = 0; action < actions.size(); ++action) {
    result.actions.push_back(Describe(actions, action));
  }
  const SearchNode& root = tree_.node(SearchTree::kRoot);
  for (int child = root.first_child; child >= 0; child = tree_.node(child).next_sibling) {
    const SearchNode& node = tree_.node(child);
    SearchAction& action = result.actions[static_cast<std::size_t>(node.action)];
    action.visits = node.visit_count;
    action.mean_value = node.mean();
    action.information_gain = node.information;
    action.terms = tree_.MeanTerms(child);
  }
  result.has_terms = tree_.keeps_terms();
  const int chosen = tree_.MostVisitedChild(SearchTree::kRoot);
  if (chosen >= 0) result.chosen = tree_.node(chosen).action;
  result.iterations = iterations_;
  result.nodes = static_cast<std::uint32_t>(tree_.size());
  result.perception_queries = information_.counts().queries;
  result.perception_calls = information_.counts().calls;
  result.perception_cached = information_.counts().cached;
  result.expected_path = ExpectedPath();
  if (options_.report == SearchDetail::kTree) {
    result.tree = MostVisitedNodes(tree_, problem_.graph, kMaxReportedNodes);
    result.views = information_.Asked(kMaxReportedViews);
  }
  return result;
}

SearchAction TreeSearch::Describe(const Actions& actions, int action) const {
  SearchAction described;
  if (actions.IsMove(action)) {
    const Edge& edge = actions.MoveOf(action);
    described.kind = CommandKind::kMove;
    described.target = problem_.graph.CellOf(edge.target);
    described.feasibility = edge.feasibility;
  } else {
    const int view = actions.views[actions.ViewOf(action)];
    described.kind = CommandKind::kTransmitView;
    described.target = problem_.graph.CellOf(problem_.start);
    described.heading_rad =
        problem_.graph.HeadingsAt(problem_.start)[static_cast<std::size_t>(view)];
    // Also of a view that was withheld.
    described.information_gain = information_.Known(path_, actions.ViewOf(action)).value_or(0.0);
  }
  return described;
}

std::vector<Cell> TreeSearch::ExpectedPath(std::optional<int> action) const {
  std::vector<Cell> cells;
  cells.reserve(static_cast<std::size_t>(options_.rollout_depth));
  int node = action ? tree_.ChildBy(SearchTree::kRoot, *action)
                    : tree_.MostVisitedChild(SearchTree::kRoot);
  while (node >= 0 && !tree_.node(node).is_communication) {
    cells.push_back(problem_.graph.CellOf(tree_.node(node).vertex));
    node = tree_.MostVisitedChild(node);
  }
  return cells;
}

}  // namespace conav::planner
