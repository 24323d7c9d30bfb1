#include "planner/search/ig_mcts.h"

#include <bit>

#include "common/runtime/result.h"
#include "planner/search/tree_report.h"

namespace conav::planner {
namespace {

std::size_t Index(int number) { return static_cast<std::size_t>(number); }

}  // namespace

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

Rollout::Rollout(const SearchOptions& options, const PathState& path, OfferedActions& offered,
                 ViewInformation& information, Random& random)
    : options_(options),
      offered_(offered),
      information_(information),
      draws_(random.Next()),
      vertices_(Index(path.graph().vertex_count())),
      outcomes_(Index(path.graph().uncertainty_count())),
      steps_(Index(options.rollout_depth)) {}

void Rollout::LookUp(VertexId number, const PathState& path, Vertex& vertex) {
  const Actions& actions = offered_.At(number);
  vertex.is_known = true;
  vertex.is_goal = path.IsGoal(number);
  vertex.actions = actions.size();
  vertex.guidance_weight = GuidanceWeight(path.guided_before(), path.IsGuidance(number));
  for (const Edge& edge : actions.moves) {
    vertex.moves.push_back({&edge, BitsBelow(edge.feasibility),
                            path.StepsToGoal(number) - path.StepsToGoal(edge.target)});
  }
}

Result<double> Rollout::Run(PathState& path) {
  ++rollout_;
  sent_information_ = kNoView;
  const int length = path.length();
  VertexId here = path.vertex();
  Vertex* at = &VertexAt(here, path);
  double rollout_return = 0.0;
  double weight = 1.0;  // gamma^t
  int t = 0;
  while (t < options_.rollout_depth && at->actions > 0) {
    const SplitMix64::Halves draw = draws_.NextHalves();
    const std::size_t action = ScaledTo(draw.upper, static_cast<std::uint32_t>(at->actions));
    if (action >= at->moves.size()) {
      const auto reward = Communicate(path, action - at->moves.size(), t);
      if (!reward) return reward;
      return rollout_return + weight * *reward;
    }
    const Move& move = at->moves[action];
    const bool goes = CanGo(move, draw.lower, path);
    steps_[Index(t)] = goes ? move.edge : nullptr;
    here = goes ? move.edge->target : here;
    at = &VertexAt(here, path);
    ++t;
    rollout_return += weight * Enter(here, *at, goes ? move.edge->length : 1.0,
                                     goes ? move.steps_saved : 0.0, length + t, path);
    weight *= options_.discount;
    if (at->is_goal) break;
  }
  steps_made_ = t;
  moves_made_ += static_cast<std::uint64_t>(t);
  return rollout_return;
}

/// Without branches, because the outcome is random.
bool Rollout::CanGo(const Move& move, std::uint32_t bits, const PathState& path) {
  const int uncertainty = move.edge->uncertainty;
  Outcome& outcome = outcomes_[Index(uncertainty)];
  const std::uint32_t drawn = bits < move.free_below ? 1 : 0;
  outcome.is_free = outcome.rollout == rollout_ ? outcome.is_free : drawn;
  outcome.rollout = rollout_;
  return (outcome.is_free | static_cast<std::uint32_t>(path.HasPassed(uncertainty))) != 0;
}

double Rollout::Enter(VertexId number, Vertex& entered, double length, double steps_saved,
                      int states, const PathState& path) {
  const int earlier = entered.rollout == rollout_ ? entered.visits : path.visits(number);
  entered.rollout = rollout_;
  entered.visits = earlier + 1;
  const double guidance = GuidanceReward(entered.guidance_weight, states);
  return MoveTerms(entered.is_goal, length, guidance, earlier, steps_saved, options_.reward).Sum();
}

void Rollout::Repeat(int t, PathState& path) const {
  if (const Edge* edge = steps_[Index(t)]) {
    path.Go(*edge);
  } else {
    path.Stay();
  }
}

Result<double> Rollout::Communicate(PathState& path, std::size_t view, int steps) {
  steps_made_ = steps;
  moves_made_ += static_cast<std::uint64_t>(steps);
  const std::size_t before = path.steps();
  for (int t = 0; t < steps; ++t) Repeat(t, path);
  Result<double> reward = information_.Of(path, view);
  if (reward) {
    sent_information_ = *reward;
    sent_heading_rad_ = path.ViewHeading(offered_.At(path.vertex()).views[view]);
    reward = RewardOfSnapshot(path, sent_heading_rad_, sent_information_, options_.reward).Sum();
  }
  if (reward && options_.optional_pictures && *reward < 0.0) {
    sent_information_ = kNoView;
    reward = 0.0;
  }
  path.TakeBack(before);
  return reward;
}

RewardTerms Rollout::Terms(PathState& path) const {
  RewardTerms terms;
  double weight = 1.0;  // gamma^t
  const std::size_t before = path.steps();
  for (int t = 0; t < steps_made_; ++t) {
    Repeat(t, path);
    terms += weight * MoveTerms(path, options_.reward);
    weight *= options_.discount;
  }
  if (sent_information_ != kNoView) {
    terms += weight *
             RewardOfSnapshot(path, sent_heading_rad_, sent_information_, options_.reward).Terms();
  }
  path.TakeBack(before);
  return terms;
}

// Stage 4: backup.

void IgMcts::Backup(int leaf, double rollout_return) {
  const bool has_terms = tree_.keeps_terms() && !tree_.node(leaf).is_terminal;
  tree_.Backup(leaf, rollout_return, options_.discount,
               has_terms ? rollout_.Terms(path_) : RewardTerms{});
}

SearchResult IgMcts::Report() {
  SearchResult result = ReportTree(tree_, problem_, offered_, information_, path_, options_.report);
  result.iterations = iterations_;
  return result;
}

}  // namespace conav::planner
