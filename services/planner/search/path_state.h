#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/runtime/random.h"
#include "planner/search/on_demand.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// tau while the search walks along a branch: steps are pushed and taken back, and what the rewards
/// ask of tau is kept up to date in constant time a step. Costs what it looks at, not what the map
/// holds.
///
/// A goal ends a branch, so goals are those that are left at the start of the decision; one on
/// which the robot stands already counts as reached.
class PathState {
 public:
  /// `steps_expected`: so many steps are taken without allocating memory.
  explicit PathState(const SearchProblem& problem, int steps_expected = 0);

  const NavigationGraph& graph() const { return graph_; }
  VertexId vertex() const { return steps_.back().vertex; }
  /// |tau|: states since the last picture, that picture's and repeats included.
  int length() const { return length_; }
  /// How often the present vertex occurs in tau before its last entry.
  int earlier_visits() const { return visits(vertex()) - 1; }
  /// How often `vertex` occurs in tau.
  int visits(VertexId vertex) const { return vertices_[Index(vertex)].visits; }
  bool at_goal() const { return IsGoal(vertex()); }
  bool on_guidance() const { return IsGuidance(vertex()); }
  /// Of any vertex: whether it is a goal left, lies on the operator's path, and its steps to the
  /// nearest goal.
  bool IsGoal(VertexId vertex) const { return vertices_[Index(vertex)].is_goal; }
  bool IsGuidance(VertexId vertex) const { return vertices_[Index(vertex)].is_guidance; }
  double StepsToGoal(VertexId vertex) const {
    std::optional<double>& steps = steps_to_goal_[Index(vertex)];
    if (!steps) steps = steps_to_goals_->From(vertex);
    return *steps;
  }
  bool guided_before() const { return guided_before_; }
  int goals_left() const { return goals_left_; }
  /// Steps to the nearest goal that the last step saved; below 0 if it led away.
  double progress() const {
    if (steps_.size() < 2) return 0.0;
    const VertexId before = steps_[steps_.size() - 2].vertex;
    return StepsToGoal(before) - StepsToGoal(vertex());
  }
  /// Of the last step, in steps.
  double step_length() const { return steps_.back().length; }
  /// Where the robot looks after its last step: the way that it came.
  double heading_rad() const;
  /// Of view `index` of the present vertex.
  double ViewHeading(int index) const { return graph_.HeadingsAt(vertex())[Index(index)]; }
  /// m: cells of the operator's path that are not in tau.
  int unvisited_guidance() const { return unvisited_guidance_; }

  /// Whether `edge` has been gone on this branch already, so that it is known to be free (A8).
  bool IsKnownFree(const Edge& edge) const {
    return edge.feasibility >= 1.0 || HasPassed(edge.uncertainty);
  }
  bool HasPassed(int uncertainty) const { return passed_[Index(uncertainty)] > 0; }

  /// The robot goes along `edge`.
  void Go(const Edge& edge) {
    Enter(edge.target);
    ++passed_[Index(edge.uncertainty)];
    steps_.push_back({edge.target, edge.uncertainty, edge.length});
  }
  /// The robot tried to move and stayed where it is: the same state once more.
  void Stay() {
    const VertexId here = vertex();
    Enter(here);
    steps_.push_back({.vertex = here});
  }

  /// Steps gone since the start of the decision; TakeBack() returns to that number.
  std::size_t steps() const { return steps_.size() - 1; }
  void TakeBack(std::size_t steps);

  /// Stands for tau as a set of vertices: two sets have the same two numbers with a probability of
  /// 2^-128 or so. Other cells of tau_0 are the same all along a decision.
  using SetKey = std::array<std::uint64_t, 2>;
  const SetKey& set_key() const { return set_key_; }
  /// The cells of tau as a set: those of its vertices, and cells of tau_0 that are no vertices; in
  /// order.
  void CollectCells(std::vector<Cell>& cells) const;

 private:
  struct Step {
    VertexId vertex = 0;
    int uncertainty = -1;  // of the edge gone, -1 for none
    double length = 1.0;   // of that edge; a robot that could not move lost one step
  };

  struct Vertex {
    int visits = 0;
    bool is_goal = false;
    bool is_guidance = false;
  };

  static std::size_t Index(int number) { return static_cast<std::size_t>(number); }
  void ReadPath(const SearchProblem& problem);
  void ReadGuidance(const SearchProblem& problem);
  void AppendCellsOf(VertexId vertex, std::vector<Cell>& cells) const;
  void Enter(VertexId vertex) {
    Vertex& entered = vertices_[Index(vertex)];
    ++length_;
    if (entered.visits++ > 0) return;
    Flip(vertex);
    unvisited_guidance_ -= entered.is_guidance ? 1 : 0;
  }
  void Leave(VertexId vertex) {
    Vertex& left = vertices_[Index(vertex)];
    --length_;
    if (--left.visits > 0) return;
    Flip(vertex);
    unvisited_guidance_ += left.is_guidance ? 1 : 0;
  }
  /// Puts `vertex` into the set or takes it out.
  void Flip(VertexId vertex) {
    SplitMix64 random(static_cast<std::uint64_t>(vertex));
    for (std::uint64_t& part : set_key_) part ^= random.Next();
  }

  const NavigationGraph& graph_;
  double start_heading_rad_;
  std::vector<Step> steps_;
  int length_ = 0;
  OnDemand<Vertex> vertices_;
  OnDemand<int> passed_;  // by uncertainty: how often edges with it were gone
  SetKey set_key_{};
  std::unique_ptr<StepsToGoals> steps_to_goals_;
  mutable OnDemand<std::optional<double>> steps_to_goal_;  // by vertex, as far as asked for
  std::vector<Cell> first_cells_;                          // of tau_0, as CollectCells()
  bool guided_before_;
  int goals_left_ = 0;
  int unvisited_guidance_ = 0;
};

}  // namespace conav::planner
