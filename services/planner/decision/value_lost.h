#pragma once

#include <span>

#include "planner/decision/method.h"
#include "planner/search/reward.h"

namespace conav::planner {

/// What a robot loses for each second of simulation time that the operator does not answer, in
/// reward units per second, so that an attention queue can compare robots and methods:
///
///   standing    V - (r_step + gamma V) = (1 - gamma) V - r_step per decision period: the return of
///               its work now, less that of the same work one period later. V is the discounted
///               return (appendix C: r_g at a goal, r_step else) of the tour to its goals, always
///               to the nearest one left, over all that is not known to be a wall. The search's
///               own values are not taken for it: rollouts at random hardly reach a goal, and the
///               methods without a search have none.
///   staleness   log n per decision period, the guidance term of appendix C, while the robot is off
///               the operator's path.
///   answer      what the search expects of the answer beyond going on, Q(view) - Q(best move), if
///               positive, spread over the time after which the robot goes on without; it is lost
///               once, not with each period. None for a robot that waits for ever.
///
/// A decision period is the time of a move from cell to cell.
struct ValueLostOptions {
  RewardOptions reward;
  double discount = 0.99;       // gamma
  double answer_timeout_s = 0;  // 0 = the robot waits for ever
};

double ValueLostPerSecond(const Situation& situation, double answer_value,
                          const ValueLostOptions& options);

/// Discounted return of the tour that ValueLostPerSecond() speaks of; 0 when no goal can be
/// reached.
double TourReturn(const Situation& situation, const ValueLostOptions& options);

/// Mean time of the robot's moves so far, with turns and pictures; 2.5 s before its first.
double DecisionPeriodSeconds(const RobotState& state);

/// Q(chosen) - Q(best move) of a search's root, at least 0; 0 without a visited move.
double AnswerValue(std::span<const SearchAction> actions, const SearchAction& chosen);

}  // namespace conav::planner
