#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "common/grid/geometry.h"
#include "common/runtime/random.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/encoding.h"
#include "nhpm/model/weights_file.h"
#include "planner/search/parallel_search.h"
#include "planner/search/path_state.h"
#include "support/steps_to_goals.h"

namespace conav::bench {

using planner::Edge;
using planner::SearchProblem;
using planner::VertexId;

inline std::shared_ptr<const nhpm::PackedWeights> Packed(const nhpm::NetworkModel& model) {
  return std::make_shared<const nhpm::PackedWeights>(model.weights,
                                                     nhpm::PackedWeights::Use::kInference);
}

inline int MovesAt(const SearchProblem& problem, VertexId vertex) {
  return static_cast<int>(problem.graph.EdgesFrom(vertex).size());
}

inline int ActionsAt(const SearchProblem& problem, VertexId vertex) {
  return MovesAt(problem, vertex) + static_cast<int>(problem.graph.HeadingsAt(vertex).size());
}

inline bool IsGoal(const SearchProblem& problem, VertexId vertex) {
  const Cell cell = problem.graph.CellOf(vertex);
  return vertex != problem.start && std::ranges::count(problem.goals_left, cell) > 0;
}

/// IG-MCTS as one would write it down from the paper and docs/paper.md: a tree of nodes that own
/// their children, tau copied into each, sets and maps, every prediction a whole pass of the
/// network, nothing remembered. Draws its random numbers in the same order as IgMcts and decides the
/// same; the peer of `conav bench planner`. Covers the default expansion only.
class PlainSearch {
 public:
  /// For maps of this size.
  PlainSearch(const planner::SearchOptions& options, const nhpm::NetworkModel& model, int rows,
              int columns)
      : options_(options),
        pass_(Packed(model), nhpm::KernelsFor(model.weights.shape.width), rows, columns),
        input_(static_cast<std::size_t>(rows * columns) * nhpm::kInputChannels) {}

  /// The chosen action as in SearchResult.
  int Decide(const SearchProblem& problem, Random& random) {
    SplitMix64 draws(random.Next());
    Node root(nullptr, -1, Walk(problem));
    const int moves = MovesAt(problem, problem.start);
    for (int view = 0; view < ActionsAt(problem, problem.start) - moves; ++view) {
      const double information = Information(problem, root.walk, view);
      const double reward = CommunicationReward(problem, root.walk, view, information);
      if (!IsWorthSending(information, reward, options_)) root.tried.insert(moves + view);
    }
    const auto full = [&](const Node& node) {
      return static_cast<int>(node.tried.size()) == ActionsAt(problem, node.walk.vertex());
    };
    if (full(root)) return -1;
    for (int i = 0; i < options_.iterations; ++i) {
      Node* node = &root;
      while (!node->terminal && full(*node)) node = Select(*node, random);
      if (!node->terminal) {
        Expand(problem, *node, random);
        node = node->children.back().get();
      }
      Backup(node, node->terminal ? 0.0 : Rollout(problem, node->walk, draws));
    }
    const Node* best = nullptr;
    for (const auto& child : root.children) {
      const bool better = best == nullptr || child->visits > best->visits ||
                          (child->visits == best->visits &&
                           (child->mean() > best->mean() ||
                            (child->mean() == best->mean() && child->action < best->action)));
      if (better) best = child.get();
    }
    return best == nullptr ? -1 : best->action;
  }

 private:
  /// tau, copied wherever it is needed.
  class Walk {
   public:
    explicit Walk(const SearchProblem& problem)
        : cells(problem.path),
          vertices{problem.start},
          steps_to_goal(test::StepsToNearestGoal(problem)) {
      const Cell start = problem.graph.CellOf(problem.start);
      if (cells.empty() || cells.back() != start) cells.push_back(start);
    }

    VertexId vertex() const { return vertices.back(); }
    void Go(const SearchProblem& problem, const Edge& edge) {
      cells.push_back(problem.graph.CellOf(edge.target));
      vertices.push_back(edge.target);
      entered.insert(edge.target);
    }
    void Stay() {
      cells.push_back(cells.back());
      vertices.push_back(vertices.back());
    }
    /// Where the robot looks: the way that it came.
    double Heading(const SearchProblem& problem) const {
      for (std::size_t i = vertices.size() - 1; i > 0; --i) {
        if (vertices[i] == vertices[i - 1]) continue;
        return HeadingTowards(problem.graph.CellOf(vertices[i - 1]),
                              problem.graph.CellOf(vertices[i]));
      }
      return problem.heading_rad;
    }
    bool IsKnownFree(const Edge& edge) const {
      return edge.feasibility >= 1.0 || entered.count(edge.target) > 0;
    }

    std::vector<Cell> cells;
    std::vector<VertexId> vertices;
    std::set<VertexId> entered;
    std::vector<double> steps_to_goal;
  };

  struct Node {
    Node(Node* parent, int action, Walk walk)
        : parent(parent), action(action), walk(std::move(walk)) {}

    Node* parent;
    int action;
    Walk walk;
    std::vector<std::unique_ptr<Node>> children;
    std::set<int> tried;
    bool terminal = false;
    int depth = 0;
    double reward = 0.0;
    double feasibility = 1.0;
    double total = 0.0;
    double visits = 0.0;

    double mean() const { return visits > 0.0 ? total / visits : 0.0; }
  };

  double Information(const SearchProblem& problem, const Walk& walk, int view) {
    PerceptionQuery query;
    query.belief = *problem.belief;
    const std::set<Cell> path(walk.cells.begin(), walk.cells.end());
    query.path.assign(path.begin(), path.end());
    query.cell = problem.graph.CellOf(walk.vertex());
    query.heading_rad = problem.graph.HeadingsAt(walk.vertex())[static_cast<std::size_t>(view)];
    query.visible = problem.graph.ViewFrom(walk.vertex(), view);
    nhpm::EncodeInput(query, {}, input_);
    return ExpectedEdits(nhpm::MaskedAnswer(query.belief, pass_.Full(input_)));
  }

  double MoveReward(const SearchProblem& problem, const Walk& walk) const {
    const VertexId here = walk.vertex();
    const VertexId before = walk.vertices[walk.vertices.size() - 2];
    const Cell cell = walk.cells.back();
    double reward = IsGoal(problem, here) ? options_.reward.goal : options_.reward.step;
    const bool guided = problem.guided_before || !problem.guidance.empty();
    if (guided && std::ranges::count(problem.guidance, cell) == 0) {
      reward += -std::log(static_cast<double>(walk.cells.size()));
    }
    reward += -static_cast<double>(std::ranges::count(walk.cells, cell) - 1);
    const auto steps = [&](VertexId v) { return walk.steps_to_goal[static_cast<std::size_t>(v)]; };
    return reward + options_.reward.progress * (steps(before) - steps(here));
  }

  double CommunicationReward(const SearchProblem& problem, const Walk& walk, int view,
                             double information) const {
    const double heading = problem.graph.HeadingsAt(walk.vertex())[static_cast<std::size_t>(view)];
    const std::set<Cell> guidance(problem.guidance.begin(), problem.guidance.end());
    const std::set<Cell> visited(walk.cells.begin(), walk.cells.end());
    const auto left =
        std::ranges::count_if(guidance, [&](Cell c) { return visited.count(c) == 0; });
    const double turn = std::abs(WrapAngle(heading - walk.Heading(problem)));
    return information -
           options_.reward.communication_cost * (1.0 + 0.1 * static_cast<double>(left)) -
           options_.reward.view_turn * turn + options_.reward.communication_step;
  }

  double Rollout(const SearchProblem& problem, Walk walk, SplitMix64& draws) {
    std::map<VertexId, bool> drawn;
    double rollout_return = 0.0;
    double weight = 1.0;
    for (int t = 0; t < options_.rollout_depth; ++t, weight *= options_.discount) {
      const int moves = MovesAt(problem, walk.vertex());
      const int actions = ActionsAt(problem, walk.vertex());
      if (actions == 0) break;
      const SplitMix64::Halves draw = draws.NextHalves();
      const int action =
          static_cast<int>(ScaledTo(draw.upper, static_cast<std::uint32_t>(actions)));
      if (action >= moves) {
        const double information = Information(problem, walk, action - moves);
        const double reward = CommunicationReward(problem, walk, action - moves, information);
        return rollout_return +
               weight * (options_.optional_pictures ? std::max(0.0, reward) : reward);
      }
      const Edge edge = problem.graph.EdgesFrom(walk.vertex())[static_cast<std::size_t>(action)];
      if (!walk.IsKnownFree(edge) && drawn.count(edge.target) == 0) {
        drawn[edge.target] = draw.lower < BitsBelow(edge.feasibility);
      }
      if (walk.IsKnownFree(edge) || drawn[edge.target]) {
        walk.Go(problem, edge);
      } else {
        walk.Stay();
      }
      rollout_return += weight * MoveReward(problem, walk);
      if (IsGoal(problem, walk.vertex())) break;
    }
    return rollout_return;
  }

  void Expand(const SearchProblem& problem, Node& node, Random& random) {
    const VertexId vertex = node.walk.vertex();
    std::vector<int> untried;
    for (int action = 0; action < ActionsAt(problem, vertex); ++action) {
      if (node.tried.count(action) == 0) untried.push_back(action);
    }
    const auto last = static_cast<std::int64_t>(untried.size()) - 1;
    const int action = untried[static_cast<std::size_t>(random.Uniform(0, last))];
    node.tried.insert(action);
    auto child = std::make_unique<Node>(&node, action, node.walk);
    child->depth = node.depth + 1;
    const int moves = MovesAt(problem, vertex);
    if (action < moves) {
      const Edge edge = problem.graph.EdgesFrom(vertex)[static_cast<std::size_t>(action)];
      child->feasibility = node.walk.IsKnownFree(edge) ? 1.0 : edge.feasibility;
      child->walk.Go(problem, edge);
      child->reward = MoveReward(problem, child->walk);
      child->terminal = IsGoal(problem, edge.target) || child->depth >= options_.rollout_depth ||
                        ActionsAt(problem, edge.target) == 0;
    } else {
      child->reward = CommunicationReward(problem, node.walk, action - moves,
                                          Information(problem, node.walk, action - moves));
      if (node.parent != nullptr && options_.optional_pictures) {
        child->reward = std::max(0.0, child->reward);
      }
      child->terminal = true;
    }
    node.children.push_back(std::move(child));
  }

  Node* Select(Node& node, Random& random) const {
    Node* best = nullptr;
    double best_value = -std::numeric_limits<double>::infinity();
    int ties = 0;
    for (const auto& child : node.children) {
      const double value = child->mean() + options_.exploration_constant *
                                               std::sqrt(std::log(node.visits) / child->visits);
      if (value > best_value) {
        best_value = value;
        best = child.get();
        ties = 1;
      } else if (value == best_value && random.Uniform(0, ties++) == 0) {
        best = child.get();
      }
    }
    return best;
  }

  void Backup(Node* leaf, double rollout_return) const {
    double sample = rollout_return;
    double feasibility = 1.0;
    for (Node* node = leaf; node != nullptr; node = node->parent) {
      sample = node->reward +
               options_.discount * (feasibility * sample + (1.0 - feasibility) * node->mean());
      node->total += sample;
      node->visits += 1.0;
      feasibility = node->feasibility;
    }
  }

  planner::SearchOptions options_;
  nhpm::InferencePass pass_;
  std::vector<float> input_;
};

}  // namespace conav::bench
