#include "planner/search/ig_mcts.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "common/runtime/demand.h"
#include "common/runtime/workers.h"
#include "planner/search/reported_tree.h"
#include "planner/search/rollout.h"
#include "planner/search/search_budget.h"
#include "planner/search/search_tree.h"
#include "planner/search/sum_of_trees.h"

namespace conav::planner {
namespace {

/// Nodes that a decision can add, or as many as are worth reserving memory for.
std::size_t NodesExpected(const SearchOptions& options) {
  constexpr std::size_t kMost = 100'000;
  const std::size_t of_iteration =
      options.expansion == Expansion::kSingle ? 1 : static_cast<std::size_t>(options.chain_depth);
  return std::min(kMost, static_cast<std::size_t>(options.iterations) * of_iteration);
}

/// The state of one tree of a decision.
class Search {
 public:
  Search(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random, const SearchMemory* memory)
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

  /// Prepares the root. False when nothing can or need be decided.
  Result<bool> Start();
  Result<void> Iterate();
  SearchResult Report();
  /// Along the most visited actions, as SearchResult::expected_path; from `action` of the root on
  /// where it is given.
  std::vector<Cell> ExpectedPath(std::optional<int> action = std::nullopt) const;
  /// Ends the search.
  void LeaveTo(SearchMemory& memory) { memory.Keep(problem_, offered_, std::move(tree_)); }

 private:
  bool IsFullyExpanded(int node);
  int Select(int node);
  Result<int> Expand(int node);
  Result<double> Evaluate(int leaf);
  void Backup(int leaf, double rollout_return);

  int UntriedAction(const Actions& actions, std::uint64_t tried);
  SearchNode Move(int parent, int action, const Edge& edge);
  Result<SearchNode> Communicate(int parent, int action, const Actions& actions);
  SearchAction Describe(const Actions& actions, int action) const;

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
  if (rollout_return) Backup(node, *rollout_return);     // stage 4
  path_.TakeBack(0);
  if (!rollout_return) return tl::unexpected(rollout_return.error());
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
  NodeTerms terms;
  if (actions.IsMove(action)) {
    const SearchNode child = Move(node, action, actions.MoveOf(action));
    if (tree_.keeps_terms()) terms.reward = MoveTerms(path_, options_.reward);
    return tree_.Add(child, terms);
  }
  const auto child = Communicate(node, action, actions);
  if (!child) return tl::unexpected(child.error());
  if (tree_.keeps_terms()) {
    terms.reward = CommunicationTerms(path_, path_.ViewHeading(child->view), child->information,
                                      options_.reward);
  }
  return tree_.Add(*child, terms);
}

Result<double> Search::Evaluate(int leaf) {
  if (tree_.node(leaf).is_terminal) return 0.0;
  return rollout_.Run(path_);
}

void Search::Backup(int leaf, double rollout_return) {
  if (tree_.keeps_terms()) {
    const bool rolled_out = !tree_.node(leaf).is_terminal;
    tree_.BackupTerms(leaf, rolled_out ? rollout_.Terms(path_) : RewardTerms{}, options_);
  }
  tree_.Backup(leaf, rollout_return, options_);
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
  child.reward =
      CommunicationReward(path_, path_.ViewHeading(child.view), *information, options_.reward);
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
    // Also of a view that was withheld.
    described.information_gain = information_.Known(path_, actions.ViewOf(action)).value_or(0.0);
  }
  return described;
}

std::vector<Cell> Search::ExpectedPath(std::optional<int> action) const {
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

/// The trees of one decision, grown side by side.
class Forest {
 public:
  Forest(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random, std::vector<SearchMemory>* memories)
      : options_(options), problem_(problem), model_(model), memories_(memories) {
    const auto count = static_cast<std::size_t>(options.trees);
    trees_.resize(count);
    if (memories != nullptr) memories->resize(count);
    if (count > 1) SeedTrees(random.Next());
    Plant(0, count > 1 ? randoms_.front() : random);
  }

  /// Asks about the root. False when nothing can or need be decided.
  Result<bool> Start() { return trees_.front()->Start(); }
  Result<void> Grow(const SearchBudget& budget);
  SearchResult Report();
  void LeaveToMemories();

 private:
  void SeedTrees(std::uint64_t seed);
  void Plant(std::size_t tree, Random& random);
  Result<void> GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget);

  const SearchOptions& options_;
  const SearchProblem& problem_;
  PerceptionModel& model_;
  std::vector<SearchMemory>* memories_;
  std::vector<Random> randoms_;  // one a tree; none for a single tree
  std::vector<std::unique_ptr<Search>> trees_;
};

void Forest::SeedTrees(std::uint64_t seed) {
  randoms_.reserve(trees_.size());
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    randoms_.emplace_back(DeriveSeed(seed, tree));
  }
}

void Forest::Plant(std::size_t tree, Random& random) {
  trees_[tree] = std::make_unique<Search>(options_, problem_, model_, random,
                                          memories_ == nullptr ? nullptr : &(*memories_)[tree]);
}

Result<void> Forest::Grow(const SearchBudget& budget) {
  const std::size_t threads =
      std::min(trees_.size(), static_cast<std::size_t>(options_.tree_threads));
  std::vector<Result<void>> ends(threads);
  RunOnWorkers(static_cast<int>(threads), static_cast<int>(threads), [&](int, int share) {
    const auto first = static_cast<std::size_t>(share);
    ends[first] = GrowShare(first, threads, budget);
  });
  for (auto& end : ends) {
    if (!end) return end;
  }
  return {};
}

/// Trees first, first + step, ...: an iteration each in turn, so that time is shared evenly.
Result<void> Forest::GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget) {
  for (std::size_t tree = first; tree < trees_.size(); tree += step) {
    if (tree == 0) continue;
    Plant(tree, randoms_[tree]);
    if (const auto started = trees_[tree]->Start(); !started) {
      return tl::unexpected(started.error());
    }
  }
  for (int i = 0; i < options_.iterations; ++i) {
    for (std::size_t tree = first; tree < trees_.size(); tree += step) {
      if (const auto done = trees_[tree]->Iterate(); !done) return done;
      if (budget.IsSpent()) return {};
    }
  }
  return {};
}

SearchResult Forest::Report() {
  if (trees_.size() == 1) return trees_.front()->Report();
  std::vector<SearchResult> of_tree;
  for (const auto& tree : trees_) {
    of_tree.push_back(tree ? tree->Report() : SearchResult{});
  }
  SearchResult sum = SumOfTrees(of_tree);
  if (sum.chosen < 0) return sum;
  const std::size_t surest = TreeWithMostVisits(of_tree, static_cast<std::size_t>(sum.chosen));
  sum.expected_path = trees_[surest]->ExpectedPath(sum.chosen);
  sum.tree = std::move(of_tree[surest].tree);
  return sum;
}

void Forest::LeaveToMemories() {
  if (memories_ == nullptr) return;
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    if (trees_[tree]) trees_[tree]->LeaveTo((*memories_)[tree]);
  }
}

}  // namespace

IgMcts::IgMcts(const SearchOptions& options, PerceptionModel& model)
    : options_(options), model_(model) {}

Result<SearchResult> IgMcts::Decide(const SearchProblem& problem, Random& random,
                                    const SearchLimits& limits,
                                    std::vector<SearchMemory>* memories) const {
  DEMAND(limits.clock != nullptr || (!limits.deadline && options_.time_budget_ms <= 0.0));
  const SearchBudget budget(options_, limits);
  SearchProblem offered = problem;
  if (options_.offers_sent_views) offered.sent_views.clear();
  const bool remembers = options_.tree_reuse != TreeReuse::kNone;
  Forest forest(options_, offered, model_, random, remembers ? memories : nullptr);
  const Result<bool> has_choice = forest.Start();
  if (!has_choice) return tl::unexpected(has_choice.error());
  if (!*has_choice) return forest.Report();
  if (const auto grown = forest.Grow(budget); !grown) return tl::unexpected(grown.error());
  SearchResult result = forest.Report();
  forest.LeaveToMemories();
  return result;
}

}  // namespace conav::planner
