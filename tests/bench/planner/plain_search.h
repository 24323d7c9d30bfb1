#pragma once

#include "common/runtime/random.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/weights_file.h"
#include "planner/search/parallel_search.h"

namespace conav::bench {

/// IG-MCTS as one would write it down from the paper and docs/paper.md: a tree of nodes that own
/// their children, tau copied into each, sets and maps, every prediction a whole pass of the
/// network, nothing remembered. Draws its random numbers in the same order as IgMcts and decides the
/// same; the peer of `conav bench planner`. Covers the default expansion only.
class PlainSearch {
 public:
  /// For maps of this size.
  PlainSearch(const planner::SearchOptions& options, const nhpm::NetworkModel& model, int rows,
              int columns);

  /// The chosen action as in SearchResult.
  int Decide(const planner::SearchProblem& problem, Random& random);

 private:
  struct Node;
  class Walk;

  double Information(const planner::SearchProblem& problem, const Walk& walk, int view);
  double MoveReward(const planner::SearchProblem& problem, const Walk& walk) const;
  double CommunicationReward(const planner::SearchProblem& problem, const Walk& walk, int view,
                             double information) const;
  double Rollout(const planner::SearchProblem& problem, Walk walk, SplitMix64& draws);
  void Expand(const planner::SearchProblem& problem, Node& node, Random& random);
  Node* Select(Node& node, Random& random) const;
  void Backup(Node* leaf, double rollout_return) const;

  planner::SearchOptions options_;
  nhpm::InferencePass pass_;
  std::vector<float> input_;
};

}  // namespace conav::bench
