#include "planner/search/ig_mcts.h"

#include <bit>

#include "common/runtime/result.h"

namespace conav::planner {

IgMcts::IgMcts(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
               Random& random)
    : options_(options),
      problem_(problem),
      random_(random),
      path_(problem, options.rollout_depth * 2),
      offered_(problem),
      information_(problem, offered_, model),
      rollout_(options, path_, offered_, information_, random),
      tree_(problem.start, NodesExpected(options), options.report != SearchDetail::kActions) {}

void IgMcts::ContinueFrom(SearchTree tree) {
  if (tree.keeps_terms() == tree_.keeps_terms()) tree_ = std::move(tree);
}

Result<bool> IgMcts::Start() {
  const Actions actions = offered_.At(problem_.start);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  if (path_.goals_left() == 0 || actions.size() == 0) return false;
  if (options_.min_information <= 0.0 && !options_.optional_pictures) return true;
  if (auto asked = information_.AskAll(path_); !asked) return tl::unexpected(asked.error());
  for (std::size_t view = 0; view < actions.views.size(); ++view) {
    const auto information = information_.Of(path_, view);
    if (!information) return tl::unexpected(information.error());
    const double heading_rad = path_.ViewHeading(actions.views[view]);
    const double reward = RewardOfSnapshot(path_, heading_rad, *information, options_.reward).Sum();
    if (IsWorthSending(*information, reward, options_)) continue;
    tree_.Withhold(SearchTree::kRoot, static_cast<int>(actions.moves.size() + view));
  }
  // The root of an earlier tree has children.
  return tree_.size() > 1 || !IsFullyExpanded(SearchTree::kRoot);
}

Result<void> IgMcts::Iterate() {
  int node = SearchTree::kRoot;
  int expansions = options_.expansion == Expansion::kChain ? kMostOfChain : 1;
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
  const Result<double> rollout_return = RollOut(node);  // stage 3
  if (rollout_return) Backup(node, *rollout_return);    // stage 4
  path_.TakeBack(0);
  if (!rollout_return) return tl::unexpected(rollout_return.error());
  ++iterations_;
  return {};
}

// Stage 1: selection.

bool IgMcts::IsFullyExpanded(int node) {
  const int actions = offered_.At(tree_.node(node).vertex).size();
  const std::uint64_t all =
      actions == kMaxActions ? ~std::uint64_t{0} : (std::uint64_t{1} << actions) - 1;
  return tree_.node(node).tried == all;
}

int IgMcts::Select(int node) {
  const int child = tree_.SelectChild(node, options_.exploration_constant, random_);
  const SearchNode& chosen = tree_.node(child);
  if (!chosen.is_communication) {
    path_.Go(offered_.At(tree_.node(node).vertex).MoveOf(chosen.action));
  }
  return child;
}

// Stage 2: expansion.

Result<int> IgMcts::Expand(int node) {
  const Actions actions = offered_.At(tree_.node(node).vertex);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  const int action = UntriedAction(actions, tree_.node(node).tried);
  if (actions.IsMove(action)) return AddMove(node, action, actions.MoveOf(action));
  return AddCommunication(node, action, actions);
}

int IgMcts::UntriedAction(const Actions& actions, std::uint64_t tried) {
  int left = 1;
  if (options_.expansion == Expansion::kRandom) {
    const int untried = actions.size() - std::popcount(tried);
    left += static_cast<int>(random_.Uniform(0, untried - 1));
  }
  int action = -1;
  while (left > 0) {
    ++action;
    if ((tried >> action & 1U) == 0) --left;
  }
  return action;
}

/// Only the transition that succeeds becomes a node; the node keeps its probability.
int IgMcts::AddMove(int parent, int action, const Edge& edge) {
  SearchNode child;
  child.parent = parent;
  child.action = action;
  child.vertex = edge.target;
  child.feasibility = path_.IsKnownFree(edge) ? 1.0 : edge.feasibility;
  path_.Go(edge);
  const RewardTerms reward = MoveTerms(path_, options_.reward);
  child.reward = reward.Sum();
  child.is_terminal = path_.at_goal() || tree_.node(parent).depth + 1 >= options_.rollout_depth ||
                      offered_.At(edge.target).size() == 0;
  return tree_.Add(child, {.reward = reward});
}

/// A picture, or the end of a branch where a picture costs more than its information is worth.
Result<int> IgMcts::AddCommunication(int parent, int action, const Actions& actions) {
  const auto information = information_.Of(path_, actions.ViewOf(action));
  if (!information) return tl::unexpected(information.error());
  SearchNode child;
  child.parent = parent;
  child.action = action;
  child.vertex = path_.vertex();
  child.is_communication = true;
  child.is_terminal = true;
  child.view = actions.views[actions.ViewOf(action)];
  const SnapshotReward reward =
      RewardOfSnapshot(path_, path_.ViewHeading(child.view), *information, options_.reward);
  const bool may_go_without = options_.optional_pictures && parent != SearchTree::kRoot;
  if (may_go_without && reward.Sum() < 0.0) return tree_.Add(child);
  child.information = *information;
  child.reward = reward.Sum();
  return tree_.Add(child, {.reward = reward.Terms()});
}

// Stage 3: rollout.

Result<double> IgMcts::RollOut(int leaf) {
  if (tree_.node(leaf).is_terminal) return 0.0;
  return rollout_.Run(path_);
}

// Stage 4: backup.

void IgMcts::Backup(int leaf, double rollout_return) {
  const bool has_terms = tree_.keeps_terms() && !tree_.node(leaf).is_terminal;
  tree_.Backup(leaf, rollout_return, options_.discount,
               has_terms ? rollout_.Terms(path_) : RewardTerms{});
}

SearchResult IgMcts::Report() {
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

SearchAction IgMcts::Describe(const Actions& actions, int action) const {
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

std::vector<Cell> IgMcts::ExpectedPath(std::optional<int> action) const {
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
