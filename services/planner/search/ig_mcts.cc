#include "planner/search/ig_mcts.h"

#include <algorithm>
#include <bit>
#include <chrono>

#include "common/runtime/demand.h"
#include "planner/search/rollout.h"
#include "planner/search/search_tree.h"

namespace conav::planner {
namespace {

/// Nodes that a decision can add, or as many as are worth reserving memory for.
std::size_t NodesExpected(const SearchOptions& options) {
  constexpr std::size_t kMost = 100'000;
  const std::size_t of_iteration =
      options.expansion == Expansion::kSingle ? 1 : static_cast<std::size_t>(options.chain_depth);
  return std::min(kMost, static_cast<std::size_t>(options.iterations) * of_iteration);
}

/// The state of one decision.
class Search {
 public:
  Search(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random, const SearchMemory* memory)
      : options_(options),
        problem_(problem),
        random_(random),
        path_(problem, options.rollout_depth * 2),
        offered_(problem),
        information_(problem, offered_, model),
        rollout_(options, path_, offered_, information_, random),
        tree_(problem.start, NodesExpected(options)) {
    if (memory == nullptr) return;
    auto branch = memory->BranchFor(problem, offered_, options, NodesExpected(options));
    if (branch) tree_ = *std::move(branch);
  }

  /// Prepares the root. False when nothing can or need be decided.
  Result<bool> Start();
  Result<void> Iterate();
  SearchResult Report();
  /// Ends the search.
  void LeaveTo(SearchMemory& memory) { memory.Keep(problem_, offered_, std::move(tree_)); }

 private:
  bool IsFullyExpanded(int node);
  int Select(int node);
  Result<int> Expand(int node);
  Result<double> Evaluate(int leaf);

  int UntriedAction(const Actions& actions, std::uint64_t tried);
  SearchNode Move(int parent, int action, const Edge& edge);
  Result<SearchNode> Communicate(int parent, int action, const Actions& actions);
  SearchAction Describe(const Actions& actions, int action) const;
  std::vector<Cell> ExpectedPath();

  const SearchOptions& options_;
  const SearchProblem& problem_;
  Random& random_;
  PathState path_;  // tau at the node that the iteration has reached
  OfferedActions offered_;
  ViewInformation information_;
  Rollout rollout_;
  SearchTree tree_;
  std::uint32_t iterations_ = 0;
};

Result<bool> Search::Start() {
  const Actions actions = offered_.At(problem_.start);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  if (path_.goals_left() == 0 || actions.size() == 0) return false;
  if (options_.min_information <= 0.0) return true;
  if (auto asked = information_.AskAll(path_); !asked) return tl::unexpected(asked.error());
  for (std::size_t view = 0; view < actions.views.size(); ++view) {
    const auto information = information_.Of(path_, view);
    if (!information) return tl::unexpected(information.error());
    if (*information >= options_.min_information) continue;
    tree_.Withhold(SearchTree::kRoot, static_cast<int>(actions.moves.size() + view));
  }
  // A root that was taken over has children.
  return tree_.size() > 1 || !IsFullyExpanded(SearchTree::kRoot);
}

Result<void> Search::Iterate() {
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
  path_.TakeBack(0);
  if (!rollout_return) return tl::unexpected(rollout_return.error());
  tree_.Backup(node, *rollout_return, options_);  // stage 4
  ++iterations_;
  return {};
}

bool Search::IsFullyExpanded(int node) {
  const int actions = offered_.At(tree_.node(node).vertex).size();
  const std::uint64_t all =
      actions == kMaxActions ? ~std::uint64_t{0} : (std::uint64_t{1} << actions) - 1;
  return tree_.node(node).tried == all;
}

int Search::Select(int node) {
  const int child = tree_.SelectChild(node, options_, random_);
  const SearchNode& chosen = tree_.node(child);
  if (!chosen.is_communication) {
    path_.Go(offered_.At(tree_.node(node).vertex).MoveOf(chosen.action));
  }
  return child;
}

Result<int> Search::Expand(int node) {
  const Actions actions = offered_.At(tree_.node(node).vertex);
  DEMAND(actions.size() <= kMaxActions, actions.size());
  const int action = UntriedAction(actions, tree_.node(node).tried);
  if (actions.IsMove(action)) return tree_.Add(Move(node, action, actions.MoveOf(action)));
  auto child = Communicate(node, action, actions);
  if (!child) return tl::unexpected(child.error());
  return tree_.Add(*std::move(child));
}

Result<double> Search::Evaluate(int leaf) {
  if (tree_.node(leaf).is_terminal) return 0.0;
  return rollout_.Run(path_);
}

int Search::UntriedAction(const Actions& actions, std::uint64_t tried) {
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
SearchNode Search::Move(int parent, int action, const Edge& edge) {
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

Result<SearchNode> Search::Communicate(int parent, int action, const Actions& actions) {
  const auto information = information_.Of(path_, actions.ViewOf(action));
  if (!information) return tl::unexpected(information.error());
  SearchNode child;
  child.parent = parent;
  child.action = action;
  child.vertex = path_.vertex();
  child.is_communication = true;
  child.is_terminal = true;
  child.view = actions.views[actions.ViewOf(action)];
  child.information = *information;
  child.reward = CommunicationReward(path_, *information, options_.reward);
  return child;
}

SearchResult Search::Report() {
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
  }
  const int chosen = tree_.MostVisitedChild(SearchTree::kRoot);
  if (chosen >= 0) result.chosen = tree_.node(chosen).action;
  result.iterations = iterations_;
  result.nodes = static_cast<std::uint32_t>(tree_.size());
  result.perception_queries = information_.counts().queries;
  result.perception_calls = information_.counts().calls;
  result.perception_cached = information_.counts().cached;
  result.expected_path = ExpectedPath();
  return result;
}

SearchAction Search::Describe(const Actions& actions, int action) const {
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
  }
  return described;
}

std::vector<Cell> Search::ExpectedPath() {
  std::vector<Cell> cells;
  cells.reserve(static_cast<std::size_t>(options_.rollout_depth));
  int node = tree_.MostVisitedChild(SearchTree::kRoot);
  while (node >= 0 && !tree_.node(node).is_communication) {
    cells.push_back(problem_.graph.CellOf(tree_.node(node).vertex));
    node = tree_.MostVisitedChild(node);
  }
  return cells;
}

/// The earliest of the caller's deadline and the options' time budget.
std::optional<Clock::TimePoint> DeadlineOf(const SearchOptions& options,
                                           const SearchLimits& limits) {
  if (limits.clock == nullptr || options.time_budget_ms <= 0.0) return limits.deadline;
  const auto budget = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double, std::milli>(options.time_budget_ms));
  const Clock::TimePoint end = limits.clock->Now() + budget;
  return limits.deadline ? std::min(end, *limits.deadline) : end;
}

}  // namespace

IgMcts::IgMcts(const SearchOptions& options, PerceptionModel& model)
    : options_(options), model_(model) {}

Result<SearchResult> IgMcts::Decide(const SearchProblem& problem, Random& random,
                                    const SearchLimits& limits, SearchMemory* memory) const {
  DEMAND(limits.clock != nullptr || (!limits.deadline && options_.time_budget_ms <= 0.0));
  SearchProblem offered = problem;
  if (options_.offers_sent_views) offered.sent_views.clear();
  const bool remembers = memory != nullptr && options_.tree_reuse != TreeReuse::kNone;
  Search search(options_, offered, model_, random, remembers ? memory : nullptr);
  const Result<bool> has_choice = search.Start();
  if (!has_choice) return tl::unexpected(has_choice.error());
  if (!*has_choice) return search.Report();
  const auto deadline = DeadlineOf(options_, limits);
  for (int i = 0; i < options_.iterations; ++i) {
    if (const auto done = search.Iterate(); !done) return tl::unexpected(done.error());
    if (limits.stop != nullptr && limits.stop->stop_requested()) break;
    if (deadline && limits.clock->Now() >= *deadline) break;
  }
  SearchResult result = search.Report();
  if (remembers) search.LeaveTo(*memory);
  return result;
}

}  // namespace conav::planner
