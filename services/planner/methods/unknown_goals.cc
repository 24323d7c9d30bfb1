#include "planner/methods/unknown_goals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/grid/geometry.h"
#include "planner/decision/traffic.h"

namespace conav::planner {
namespace {

/// The chance that a person notices a goal in a picture of it: nobody has measured it.
constexpr double kNoticed = 0.5;
/// A cell less likely than this, after 20 pictures of it, is not looked at again.
constexpr float kHardlyLikely = 1e-6F;

double Sum(const Grid<float>& grid) {
  return std::accumulate(grid.values().begin(), grid.values().end(), 0.0);
}

/// From the robot to the likeliest cell that it can reach, else to the nearest of the next likely.
std::vector<Cell> PathToLikeliest(const Situation& situation, const Grid<float>& likelihood) {
  const OccupancyGrid& map = situation.map.cells;
  std::vector<Cell> path;
  for (float least = *std::ranges::max_element(likelihood.values());
       path.empty() && least > kHardlyLikely; least *= static_cast<float>(1.0 - kNoticed)) {
    path = PathToNearest(
        map, situation.state.cell, [&](Cell cell) { return map[cell] != Occupancy::kOccupied; },
        [&](Cell cell) { return likelihood[cell] >= least && cell != situation.state.cell; });
  }
  return path;
}

}  // namespace

void AnswerTrust::Update(const Situation& situation) {
  const std::vector<Cell>& reached = situation.state.goals_reached;
  if (reached.size() < reached_) *this = {};  // the world restarted
  for (; reached_ < reached.size(); ++reached_) {
    if (Contains(path_, reached[reached_])) in_vain_ = 0;
  }
  if (situation.guidance) path_ = situation.guidance->path;
}

double AnswerTrust::value() const { return std::ldexp(1.0, -in_vain_); }

void HiddenGoals::Pictured(const VisibleCells& visible, const Situation& situation) {
  if (situation.goals_to_find == 0) return;
  const OccupancyGrid& map = situation.map.cells;
  if (likelihood_.size() != map.size()) {
    likelihood_ = Grid<float>(map.rows(), map.columns(), 1.0F);
  }
  const double all = Sum(likelihood_);
  for (const Cell cell : visible.free) {
    expected_ += kNoticed * situation.goals_to_find * likelihood_[cell] / all;
    likelihood_[cell] *= static_cast<float>(1.0 - kNoticed);
  }
}

void HiddenGoals::AddTo(SearchProblem& problem, const Situation& situation,
                        double goal_reward) const {
  if (situation.goals_to_find == 0) return;
  const OccupancyGrid& map = situation.map.cells;
  problem.hidden =
      likelihood_.size() == map.size() ? likelihood_ : Grid<float>(map.rows(), map.columns(), 1.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == Occupancy::kOccupied) problem.hidden.values()[i] = 0.0F;
  }
  const double all = Sum(problem.hidden);
  if (all == 0.0) return;
  // Finding a goal is worth reaching it.
  const double found = situation.state.goals_total - situation.goals_to_find;
  problem.hidden_value =
      kNoticed * goal_reward * situation.goals_to_find / all * (1.0 + found) / (1.0 + expected_);
  problem.sent_views.clear();  // a second picture may show what was overlooked in the first
  if (!problem.goals_left.empty()) return;
  const std::vector<Cell> path = PathToLikeliest(situation, problem.hidden);
  if (!path.empty()) problem.goals_left.push_back(path.back());
}

}  // namespace conav::planner
