#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"
#include "planner/search/view_information.h"

// One user: parallel_search; it is the algorithm.

namespace conav::planner {

/// Stage 3 of an iteration: actions drawn uniformly (A6) from the end of a path until a goal is
/// reached, a view is sent (or would be, if it were worth its cost) or the depth is used up
/// (procedure ROLLOUT, appendix C). Whether an unknown cell is free is drawn once per rollout and
/// remembered; a robot that cannot move stays where it is (A8).
///
/// A rollout keeps its moves apart from the path: the data of a move fits in a few kilobytes, and
/// the path is walked only to ask about a view. A move takes one draw of a SplitMix64 that is seeded
/// from `random` at construction, upper half for the action, lower half for whether the cell is
/// free, and hardly any branch that a processor could predict wrongly. Allocates memory for the
/// vertices that it comes to first only.
class Rollout {
 public:
  /// All arguments but `random` must outlive this. `path` is a path of the decision: goals and the
  /// like are those of all paths.
  Rollout(const SearchOptions& options, const PathState& path, OfferedActions& offered,
          ViewInformation& information, Random& random);

  /// Discounted return of the steps after `path`, which is unchanged at the end. 0 when nothing is
  /// offered. Errors: those of the perception model.
  [[nodiscard]] Result<double> Run(PathState& path);

  /// The terms of the return of the newest Run(), from `path`. Repeats its steps, so that rollouts
  /// are not slowed down by terms that no report asks for.
  RewardTerms Terms(PathState& path) const;

  /// Moves made so far, in all rollouts.
  std::uint64_t moves() const { return moves_made_; }

 private:
  struct Move {
    const Edge* edge = nullptr;
    std::uint64_t free_below = 0;  // BitsBelow(feasibility)
    double steps_saved = 0.0;
  };
  /// A vertex: its actions, what MoveTerms() needs of it, and how often a rollout was there: the
  /// present one if `rollout` is its number.
  struct Vertex {
    bool is_known = false;
    bool is_goal = false;
    std::uint32_t rollout = 0;
    int visits = 0;
    int actions = 0;               // moves and views
    double guidance_weight = 0.0;  // GuidanceWeight()
    std::vector<Move> moves;
  };
  /// The outcome that this rollout drew for an uncertainty; none unless `rollout` is the present one.
  struct Outcome {
    std::uint32_t rollout = 0;
    std::uint32_t is_free = 0;
  };

  static constexpr double kNoView = -1.0;

  Vertex& VertexAt(VertexId number, const PathState& path) {
    Vertex& vertex = vertices_[static_cast<std::size_t>(number)];
    if (!vertex.is_known) [[unlikely]] {
      LookUp(number, path, vertex);
    }
    return vertex;
  }
  void LookUp(VertexId number, const PathState& path, Vertex& vertex);
  bool CanGo(const Move& move, std::uint32_t bits, const PathState& path);
  /// The reward of being at `entered`, number `number`, as the `states`-th state of tau, after a
  /// step of `length`.
  double Enter(VertexId number, Vertex& entered, double length, double steps_saved, int states,
               const PathState& path);
  /// `path` makes step t of this rollout.
  void Repeat(int t, PathState& path) const;
  [[nodiscard]] Result<double> Communicate(PathState& path, std::size_t view, int steps);

  const SearchOptions& options_;
  OfferedActions& offered_;
  ViewInformation& information_;
  SplitMix64 draws_;
  OnDemand<Vertex> vertices_;
  OnDemand<Outcome> outcomes_;         // by uncertainty
  std::vector<const Edge*> steps_;     // of this rollout; null = stayed
  int steps_made_ = 0;                 // of this rollout
  double sent_information_ = kNoView;  // of the view that ended it
  double sent_heading_rad_ = 0.0;      // and where it looks
  std::uint32_t rollout_ = 0;          // number of the present one
  std::uint64_t moves_made_ = 0;
};

/// Information Gain Monte Carlo Tree Search: decides whether a robot moves, and where to, or shows
/// the operator a view, and which. One tree; ParallelSearch makes a decision of one tree or several.
///
/// A node is the path since the last picture. The operator's belief is the same in all nodes, as a
/// communication ends its branch (A12) and a move tells the operator nothing. Each iteration:
///   1. Selection: from the root down by UCB while all actions of a node were tried.
///   2. Expansion: an untried action becomes a child, its reward is computed (reward.h).
///   3. Rollout: random actions from there (Rollout).
///   4. Backup: the return goes up to the root, weighted by feasibility (search_tree.h).
/// The chosen action is the most visited one of the root.
///
/// Limits:  at most 64 actions at a vertex. About 100 bytes of memory per iteration, and the views'
///          information. An iteration asks the model about at most one view and allocates nothing.
/// Repeats: the same problem, options and state of `random` give the same tree.
/// Threads: one at a time.
/// Sources: the paper, section 5 and appendix E; docs/paper.md says how conav reads it. UCT: Kocsis
///          and Szepesvari, "Bandit Based Monte-Carlo Planning", ECML 2006.
class IgMcts {
 public:
  /// All arguments must outlive this.
  IgMcts(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random);

  /// Continues from an earlier tree, whose root is the problem's start. Before Start(); ignored if
  /// only one of them keeps terms.
  void ContinueFrom(SearchTree tree);

  /// Prepares the root: asks about its views, in one batch, and withholds those that are not worth
  /// sending. False when there is nothing to decide. Errors: those of the perception model, as of
  /// Iterate().
  [[nodiscard]] Result<bool> Start();
  /// Stages 1 to 4 once. Requires Start() == true.
  [[nodiscard]] Result<void> Iterate();

  SearchResult Report();

  OfferedActions& offered() { return offered_; }
  const SearchTree& tree() const { return tree_; }
  /// Ends the search.
  SearchTree TakeTree() { return std::move(tree_); }

 private:
  int Select(int node);                            // stage 1: one step down
  [[nodiscard]] Result<int> Expand(int node);      // stage 2
  [[nodiscard]] Result<double> RollOut(int leaf);  // stage 3
  void Backup(int leaf, double rollout_return);    // stage 4

  bool IsFullyExpanded(int node);
  int UntriedAction(const Actions& actions, std::uint64_t tried);
  int AddMove(int parent, int action, const Edge& edge);
  [[nodiscard]] Result<int> AddCommunication(int parent, int action, const Actions& actions);

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

}  // namespace conav::planner
