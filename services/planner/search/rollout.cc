#include "planner/search/rollout.h"

namespace conav::planner {

Rollout::Rollout(const SearchOptions& options, const SearchProblem& problem,
                 const OfferedActions& offered, ViewInformation& information, Random& random)
    : options_(options),
      offered_(offered),
      information_(information),
      random_(random),
      outcomes_(static_cast<std::size_t>(problem.graph.uncertainty_count()), Outcome::kNotDrawn) {
  drawn_.reserve(outcomes_.size());
}

Result<double> Rollout::Run(PathState& path) {
  const std::size_t steps = path.steps();
  Result<double> rollout_return = Walk(path);
  path.TakeBack(steps);
  for (const int uncertainty : drawn_) {
    outcomes_[static_cast<std::size_t>(uncertainty)] = Outcome::kNotDrawn;
  }
  drawn_.clear();
  return rollout_return;
}

Result<double> Rollout::Walk(PathState& path) {
  double rollout_return = 0.0;
  double weight = 1.0;  // gamma^t
  for (int t = 0; t < options_.rollout_depth; ++t, weight *= options_.discount) {
    const Actions actions = offered_.At(path.vertex());
    if (actions.size() == 0) break;
    const int action = DrawAction(actions);
    if (!actions.IsMove(action)) {
      const auto information = information_.Of(path, actions.ViewOf(action));
      if (!information) return information;
      return rollout_return + weight * CommunicationReward(path, *information, options_.reward);
    }
    Move(actions.MoveOf(action), path);
    ++moves_;
    rollout_return += weight * MoveReward(path, options_.reward);
    if (path.at_goal()) break;
  }
  return rollout_return;
}

int Rollout::DrawAction(const Actions& actions) {
  const auto moves = static_cast<std::int64_t>(actions.moves.size());
  const auto all = static_cast<std::int64_t>(actions.size());
  const double probability = options_.rollout_communication_probability;
  if (probability < 0.0 || moves == 0 || moves == all) {
    return static_cast<int>(random_.Uniform(0, all - 1));
  }
  if (random_.Chance(probability)) return static_cast<int>(random_.Uniform(moves, all - 1));
  return static_cast<int>(random_.Uniform(0, moves - 1));
}

void Rollout::Move(const Edge& edge, PathState& path) {
  if (path.IsKnownFree(edge) || DrawFree(edge)) {
    path.Go(edge);
  } else {
    path.Stay();
  }
}

bool Rollout::DrawFree(const Edge& edge) {
  Outcome& outcome = outcomes_[static_cast<std::size_t>(edge.uncertainty)];
  if (outcome == Outcome::kNotDrawn) {
    outcome = random_.Chance(edge.feasibility) ? Outcome::kFree : Outcome::kBlocked;
    drawn_.push_back(edge.uncertainty);
  }
  return outcome == Outcome::kFree;
}

}  // namespace conav::planner
