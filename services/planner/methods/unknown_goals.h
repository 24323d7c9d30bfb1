#pragma once

#include <cstddef>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "planner/decision/method.h"
#include "planner/search/search_problem.h"

// One user: the method; trust and likelihoods are tested by themselves.

namespace conav::planner {

/// How much the next answer is trusted to lead a robot that lacks a way (Situation::lacks_way) to a goal: an
/// addition to the paper, whose robots know their goals (docs/scenarios.md).
class AnswerTrust {
 public:
  /// At each decision, before Asked().
  void Update(const Situation& situation);

  /// A picture was sent because the robot lacked a way.
  void Asked() { ++in_vain_; }

  /// In (0, 1]: halved by each such picture since a goal on the operator's path was last reached.
  double value() const;

 private:
  int in_vain_ = 0;
  std::vector<Cell> path_;  // the operator's newest, also after it is used up
  std::size_t reached_ = 0;
};

/// Goals that somebody else has to find in pictures (GoalKnowledge::kTold): where they may be and what
/// showing that is worth. Each cell is as likely to hide one as any other until a picture has shown it.
class HiddenGoals {
 public:
  /// A picture of `visible` was sent.
  void Pictured(const VisibleCells& visible, const Situation& situation);

  /// Adds to `problem` what pictures are worth to find goals in, and where to look for them when the robot
  /// has no other goal: `goal_reward`, times (1 + found) / (1 + expected) of the pictures so far. Nothing
  /// while no goal is hidden.
  void AddTo(SearchProblem& problem, const Situation& situation, double goal_reward) const;

 private:
  Grid<float> likelihood_;  // that a cell still hides a goal, relative to others; empty = all alike
  double expected_ = 0.0;   // goals that all pictures together should have shown
};

}  // namespace conav::planner
