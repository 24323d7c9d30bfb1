#pragma once

#include <array>
#include <cmath>

#include "common/msg/search_report.h"
#include "planner/search/path_state.h"

namespace conav {
class ConfigReader;
}

namespace conav::planner {

/// Numbers of the reward, appendix C of the paper.
struct RewardOptions {
  double goal = 100.0;  // r_g
  double step = -1.0;   // R_env of any other step, times its length (Edge::length)
  /// c of a picture, in expected edits (cells), is communication_cost (1 + communication_guidance m);
  /// 10 gives the paper's 10 + m. Hardly any picture is worth that much where a branch may end without one
  /// (SearchOptions::optional_pictures), so the default is lower; an experiment chose it
  /// (docs/search.md).
  double communication_cost = 0.25;
  /// What each state of the operator's path that was not visited adds to c, as a share of
  /// communication_cost. 0 is a fixed cost: that of the waterway (section 6.3).
  double communication_guidance = 0.1;
  /// Added to a communication as to any other step; the paper does not say so, hence 0.
  double communication_step = 0.0;

  /// Cost of the turn towards a view, per radian between the robot's direction of travel and the
  /// view's heading; an addition to the paper, where turning is free. A move from cell to cell costs
  /// `step`; in the simulator turning one radian there and back takes about as long as one move.
  double view_turn = 1.0;

  /// What the answer to a picture is worth to a robot that lacks a way (Situation::lacks_way), in goals:
  /// it leads to the next one. An addition to the paper.
  double answer = 1.0;

  /// Weight of the progress term, an addition to the paper (which allows for one, section 5.1).
  double progress = 1.0;

  void Visit(ConfigReader& reader);
};

/// R_env(tau): r_g on entering a goal for the first time, else the step penalty (appendix C, 1), for
/// each step of the move's `length`.
inline double EnvironmentReward(bool reaches_goal, const RewardOptions& options,
                                double length = 1.0) {
  return reaches_goal ? options.goal : options.step * length;
}

inline const std::array<double, 512> log_table = [] {
  std::array<double, 512> logarithms{};
  for (std::size_t n = 1; n < logarithms.size(); ++n) logarithms[n] = std::log(n);
  return logarithms;
}();

/// R_guidance(tau, zeta): 0 on the operator's path, else -log n, where n = |tau| counts the states
/// since the last picture, that picture's included (appendix C, 2). 0 while no path was ever given.
/// The weight of log n is 0 or -1 and belongs to a vertex.
inline double GuidanceWeight(bool guided_before, bool on_guidance) {
  return guided_before && !on_guidance ? -1.0 : 0.0;
}
inline double GuidanceReward(double weight, int path_length) {
  const auto n = static_cast<std::size_t>(path_length);
  return weight * (n < log_table.size() ? log_table[n] : std::log(n));
}

/// R_smooth(tau): minus the number of earlier visits to the present state (appendix C, 3).
inline double SmoothnessReward(int earlier_visits) { return -static_cast<double>(earlier_visits); }

/// Steps to the nearest goal, by the robot's own map, that a move saves; below 0 when it leads
/// away. Not in the paper: it shows the search goals beyond its horizon. It is an undiscounted
/// difference of potentials, so it hardly changes which path is best (with the discount factor it
/// would not at all: Ng, Harada and Russell, ICML 1999); a communication gets none of it.
inline double ProgressReward(double steps_saved, const RewardOptions& options) {
  return options.progress * steps_saved;
}

/// c, where m counts the states of zeta that the robot has not visited: 10 + m in appendix C.
inline double CommunicationCost(int unvisited_guidance, const RewardOptions& options) {
  return options.communication_cost * (1.0 + options.communication_guidance * unvisited_guidance);
}

/// R_task of a step that enters a state: the sum of the first four. `length` is that of the step,
/// `guidance` is GuidanceReward().
inline RewardTerms MoveTerms(bool reaches_goal, double length, double guidance, int earlier_visits,
                             double steps_saved, const RewardOptions& options) {
  const double environment = EnvironmentReward(reaches_goal, options, length);
  return {.goals = reaches_goal ? environment : 0.0,
          .steps = reaches_goal ? 0.0 : environment,
          .progress = ProgressReward(steps_saved, options),
          .guidance = guidance,
          .smoothness = SmoothnessReward(earlier_visits)};
}

/// Of the step that `path` has just made.
inline RewardTerms MoveTerms(const PathState& path, const RewardOptions& options) {
  return MoveTerms(
      path.at_goal(), path.step_length(),
      GuidanceReward(GuidanceWeight(path.guided_before(), path.on_guidance()), path.length()),
      path.earlier_visits(), path.progress(), options);
}

/// What it costs to look towards `heading_rad` at the end of `path`.
double TurnCost(const PathState& path, double heading_rad, const RewardOptions& options);

/// What a picture is worth: R_info - c - turn. No guidance or smoothness term, as no new state is
/// entered.
struct SnapshotReward {
  double information = 0.0;  // E||x' - x||_1 = ||p_add||_1 + ||p_remove||_1 (section 5.2)
  double cost = 0.0;         // c, CommunicationCost()
  double turn = 0.0;         // TurnCost()
  double step = 0.0;         // RewardOptions::communication_step

  double Sum() const { return information - cost - turn + step; }
  /// For reports: the turn counts as a cost of communication. The sum is the same but for rounding.
  RewardTerms Terms() const {
    return {.steps = step, .information = information, .communication = -cost - turn};
  }
};

/// Of a picture towards `heading_rad` at the end of `path`.
inline SnapshotReward RewardOfSnapshot(const PathState& path, double heading_rad,
                                       double information, const RewardOptions& options) {
  return {information, CommunicationCost(path.unvisited_guidance(), options),
          TurnCost(path, heading_rad, options), options.communication_step};
}

}  // namespace conav::planner
