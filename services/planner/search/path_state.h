#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/search/search_problem.h"

namespace conav::planner {

/// Expected number of steps from each vertex to the nearest goal left, other than the start, by
/// what the robot knows: an edge counts as its length / feasibility. Where no goal can be
/// reached the number is that of the farthest vertex plus one, 0 if there is none.
std::vector<double> StepsToNearestGoal(const SearchProblem& problem);

/// tau while the search walks along a branch: steps are pushed and taken back, and what the rewards
/// ask of tau is kept up to date in constant time a step.
///
/// A goal ends a branch, so goals are those that are left at the start of the decision; one on
/// which the robot stands already counts as reached.
class PathState {
 public:
  /// `steps_expected`: so many steps are taken without allocating memory.
  explicit PathState(const SearchProblem& problem, int steps_expected = 0);

  std::size_t vertex_count() const { return visits_.size(); }
  std::size_t uncertainty_count() const { return passed_.size(); }
  VertexId vertex() const { return steps_.back().vertex; }
  /// |tau|: states since the last picture, that picture's and repeats included.
  int length() const { return length_; }
  /// How often the present vertex occurs in tau before its last entry.
  int earlier_visits() const { return visits_[Index(vertex())] - 1; }
  /// How often `vertex` occurs in tau.
  int visits(VertexId vertex) const { return visits_[Index(vertex)]; }
  bool at_goal() const { return IsGoal(vertex()); }
  bool on_guidance() const { return IsGuidance(vertex()); }
  /// Of any vertex: whether it is a goal left, lies on the operator's path, and its steps to the
  /// nearest goal.
  bool IsGoal(VertexId vertex) const { return is_goal_[Index(vertex)] != 0; }
  bool IsGuidance(VertexId vertex) const { return is_guidance_[Index(vertex)] != 0; }
  double StepsToGoal(VertexId vertex) const { return steps_to_goal_[Index(vertex)]; }
  bool guided_before() const { return guided_before_; }
  int goals_left() const { return goals_left_; }
  /// Steps to the nearest goal that the last step saved; below 0 if it led away.
  double progress() const {
    if (steps_.size() < 2) return 0.0;
    const VertexId before = steps_[steps_.size() - 2].vertex;
    return steps_to_goal_[Index(before)] - steps_to_goal_[Index(vertex())];
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

  /// tau as a set of vertices: bit v of word v / 64. Other cells of tau_0 are the same all along a
  /// decision.
  std::span<const std::uint64_t> visited() const { return visited_; }
  /// Cells of tau_0 that are no vertices.
  std::span<const Cell> other_cells() const { return other_cells_; }

 private:
  struct Step {
    VertexId vertex = 0;
    int uncertainty = -1;  // of the edge gone, -1 for none
    double length = 1.0;   // of that edge; a robot that could not move lost one step
  };

  static std::size_t Index(int number) { return static_cast<std::size_t>(number); }
  void ReadPath(const SearchProblem& problem);
  void ReadGuidance(const SearchProblem& problem);
  void Enter(VertexId vertex) {
    ++length_;
    if (visits_[Index(vertex)]++ > 0) return;
    visited_[Index(vertex) / 64] |= std::uint64_t{1} << (vertex % 64);
    unvisited_guidance_ -= is_guidance_[Index(vertex)];
  }
  void Leave(VertexId vertex) {
    --length_;
    if (--visits_[Index(vertex)] > 0) return;
    visited_[Index(vertex) / 64] &= ~(std::uint64_t{1} << (vertex % 64));
    unvisited_guidance_ += is_guidance_[Index(vertex)];
  }

  const NavigationGraph& graph_;
  double start_heading_rad_;
  std::vector<Step> steps_;
  int length_ = 0;
  std::vector<int> visits_;  // by vertex
  std::vector<std::uint64_t> visited_;
  std::vector<int> passed_;  // by uncertainty: how often edges with it were gone
  std::vector<std::uint8_t> is_goal_;
  std::vector<std::uint8_t> is_guidance_;
  std::vector<double> steps_to_goal_;  // by vertex
  std::vector<Cell> other_cells_;
  bool guided_before_;
  int goals_left_ = 0;
  int unvisited_guidance_ = 0;
};

}  // namespace conav::planner
