#pragma once

#include <cstdint>
#include <vector>

#include "common/msg/search_report.h"
#include "common/runtime/random.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// At one vertex, moves and views together: they are bits of one word.
inline constexpr int kMaxActions = 64;

/// One node: the state after an action, and the statistics of its visits. Nodes are indices into
/// one array; a node's children form a list in the order of their expansion.
///
///   parent <- node -> first_child -> next_sibling -> next_sibling ...
struct SearchNode {
  int parent = -1;
  int first_child = -1;
  int last_child = -1;
  int next_sibling = -1;
  int action = -1;  // at the parent's vertex, see Actions
  int view = -1;    // of a communication: index into NavigationGraph::HeadingsAt()
  int depth = 0;
  VertexId vertex = 0;
  bool is_communication = false;
  bool is_terminal = false;
  std::uint64_t tried = 0;        // bit a: action a has a child, or is withheld
  double reward = 0.0;            // r(v): of the transition into this node; 0 at the root
  double feasibility = 1.0;       // delta(v): probability of that transition
  double information = 0.0;       // R_info of a communication
  std::uint32_t visit_count = 0;  // N(v)
  double total_return = 0.0;      // Q(v)

  /// Q/N, 0 while unvisited.
  double mean() const { return visit_count > 0 ? total_return / visit_count : 0.0; }
};

/// The terms of a node's reward r(v) and of its total return Q(v).
struct NodeTerms {
  RewardTerms reward;
  RewardTerms total;
};

/// Number of nodes that a decision can add, or as many as are worth reserving memory for.
std::size_t NodesExpected(const SearchOptions& options);

/// The tree and the stages that need no knowledge of the world: selection by UCB and backup; and the
/// choice of the action.
class SearchTree {
 public:
  static constexpr int kRoot = 0;

  /// Adds up to `nodes_expected` nodes without allocating memory. With `keeps_terms` each node has
  /// its NodeTerms, for reports.
  explicit SearchTree(VertexId start, std::size_t nodes_expected = 0, bool keeps_terms = false);

  const SearchNode& node(int index) const { return nodes_[static_cast<std::size_t>(index)]; }
  std::size_t size() const { return nodes_.size(); }

  bool keeps_terms() const { return !terms_.empty(); }
  /// Requires keeps_terms().
  const NodeTerms& terms(int index) const { return terms_[static_cast<std::size_t>(index)]; }
  /// Terms of Q/N; zeros while unvisited or when no terms are kept.
  RewardTerms MeanTerms(int index) const;

  /// Appends `node` as last child of its parent; returns its number. `terms` are kept or dropped.
  int Add(SearchNode node, const NodeTerms& terms = {});

  /// The statistics of the root in an earlier tree.
  void SetRootVisits(std::uint32_t visit_count, double total_return) {
    mutable_node(kRoot).visit_count = visit_count;
    mutable_node(kRoot).total_return = total_return;
  }
  void SetRootTerms(const RewardTerms& total) {
    if (keeps_terms()) terms_[kRoot].total = total;
  }

  /// Never expands `action` of `node`.
  void Withhold(int node, int action) { mutable_node(node).tried |= std::uint64_t{1} << action; }

  /// The child with the largest UCB (algorithm 1, line 8): Q/N + k sqrt(log N(parent) / N). Ties
  /// are broken at random. Requires children.
  int SelectChild(int parent, double exploration_constant, Random& random) const;

  /// Stage 4 (equation 3, procedure BackPropagate): from `leaf` up to the root,
  ///   q_sample <- r(v) + gamma [ delta q_sample + (1 - delta) Q(v)/N(v) ],  Q += q_sample,  N += 1
  /// with delta = 1 at the leaf and the child's feasibility above (A1). `terms` are those of
  /// `rollout_return`; they go up by the same formula where the tree keeps terms.
  void Backup(int leaf, double rollout_return, double discount, const RewardTerms& terms = {});

  /// The most visited child; ties by higher mean, then lower action number (A27). -1 without any.
  int MostVisitedChild(int parent) const;

 private:
  SearchNode& mutable_node(int index) { return nodes_[static_cast<std::size_t>(index)]; }

  std::vector<SearchNode> nodes_;
  std::vector<NodeTerms> terms_;  // by node, or empty
};

}  // namespace conav::planner
