#include "planner/search/search_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/runtime/result.h"

namespace conav::planner {

std::size_t NodesExpected(const SearchOptions& options) {
  const int of_iteration = options.expansion == Expansion::kChain ? kMostOfChain : 1;
  return static_cast<std::size_t>(std::min(100'000, options.iterations * of_iteration));
}

SearchTree::SearchTree(VertexId start, std::size_t nodes_expected, bool keeps_terms) {
  nodes_.reserve(nodes_expected + 1);
  nodes_.emplace_back().vertex = start;
  if (!keeps_terms) return;
  terms_.reserve(nodes_expected + 1);
  terms_.emplace_back();
}

RewardTerms SearchTree::MeanTerms(int index) const {
  if (!keeps_terms() || node(index).visit_count == 0) return {};
  return 1.0 / node(index).visit_count * terms(index).total;
}

int SearchTree::Add(SearchNode node, const NodeTerms& terms) {
  DEMAND(node.parent >= 0 && node.action >= 0 && node.action < kMaxActions, node.parent,
         node.action);
  const int index = static_cast<int>(nodes_.size());
  SearchNode& parent = mutable_node(node.parent);
  node.depth = parent.depth + 1;
  parent.tried |= std::uint64_t{1} << node.action;
  if (parent.last_child < 0) {
    parent.first_child = index;
  } else {
    mutable_node(parent.last_child).next_sibling = index;
  }
  parent.last_child = index;
  nodes_.push_back(node);
  if (keeps_terms()) terms_.push_back(terms);
  return index;
}

int SearchTree::SelectChild(int parent, double exploration_constant, Random& random) const {
  const SearchNode& from = node(parent);
  const double log_visits = std::log(static_cast<double>(from.visit_count));
  double best_value = -std::numeric_limits<double>::infinity();
  int best = -1;
  int ties = 0;
  for (int child = from.first_child; child >= 0; child = node(child).next_sibling) {
    const SearchNode& to = node(child);
    const double value = to.mean() + exploration_constant * std::sqrt(log_visits / to.visit_count);
    if (value > best_value) {
      best_value = value;
      best = child;
      ties = 1;
    } else if (value == best_value && random.Uniform(0, ties++) == 0) {
      best = child;
    }
  }
  DEMAND(best >= 0, parent);
  return best;
}

namespace {

/// q_sample of a node, or one of its terms: equation 3. `mean` is asked only where it counts.
template <class Value, class Mean>
Value Propagated(const Value& reward, double discount, double feasibility, const Value& below,
                 const Mean& mean) {
  Value expected = feasibility * below;
  if (feasibility < 1.0) expected += (1.0 - feasibility) * mean();
  Value sample = discount * expected;
  sample += reward;
  return sample;
}

}  // namespace

void SearchTree::Backup(int leaf, double rollout_return, double discount,
                        const RewardTerms& terms) {
  double sample = rollout_return;
  RewardTerms sample_terms = terms;
  double feasibility = 1.0;
  for (int index = leaf; index >= 0; index = node(index).parent) {
    SearchNode& v = mutable_node(index);
    if (keeps_terms()) {
      NodeTerms& of_v = terms_[static_cast<std::size_t>(index)];
      sample_terms = Propagated(of_v.reward, discount, feasibility, sample_terms,
                                [&] { return MeanTerms(index); });
      of_v.total += sample_terms;
    }
    sample = Propagated(v.reward, discount, feasibility, sample, [&] { return v.mean(); });
    v.total_return += sample;
    ++v.visit_count;
    feasibility = v.feasibility;
  }
}

int SearchTree::MostVisitedChild(int parent) const {
  const auto rank = [&](int child) {
    return std::tuple(node(child).visit_count, node(child).mean(), -node(child).action);
  };
  int best = -1;
  for (int child = node(parent).first_child; child >= 0; child = node(child).next_sibling) {
    if (best < 0 || rank(child) > rank(best)) best = child;
  }
  return best;
}

}  // namespace conav::planner
