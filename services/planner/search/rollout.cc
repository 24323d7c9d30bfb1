#include "planner/search/rollout.h"

namespace conav::planner {
namespace {

const LogTable& SharedLogTable() {
  static const LogTable table;
  return table;
}

}  // namespace

Rollout::Rollout(const SearchOptions& options, const PathState& path, const OfferedActions& offered,
                 ViewInformation& information, Random& random)
    : options_(options),
      offered_(offered),
      information_(information),
      random_(random),
      log_(SharedLogTable()),
      vertices_(path.vertex_count()),
      visits_(path.vertex_count()),
      outcomes_(path.uncertainty_count()) {
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto vertex = static_cast<VertexId>(i);
    const bool guides = path.guided_before() && !path.IsGuidance(vertex);
    vertices_[i] = {EnvironmentReward(path.IsGoal(vertex), options.reward), guides ? -1.0 : 0.0,
                    path.StepsToGoal(vertex), path.IsGoal(vertex)};
  }
  steps_.reserve(static_cast<std::size_t>(options.rollout_depth));
}

Result<double> Rollout::Run(PathState& path) {
  ++rollout_;
  steps_.clear();
  length_ = path.length();
  VertexId here = path.vertex();
  double rollout_return = 0.0;
  double weight = 1.0;  // gamma^t
  for (int t = 0; t < options_.rollout_depth; ++t, weight *= options_.discount) {
    const Actions actions = offered_.At(here);
    if (actions.size() == 0) break;
    const int action = DrawAction(actions);
    if (!actions.IsMove(action)) {
      const auto reward = Communicate(path, actions.ViewOf(action));
      if (!reward) return reward;
      return rollout_return + weight * *reward;
    }
    const Edge& edge = actions.MoveOf(action);
    const bool goes = CanGo(edge, path);
    steps_.push_back(goes ? &edge : nullptr);
    const VertexId next = goes ? edge.target : here;
    rollout_return += weight * Enter(here, next, path);
    here = next;
    if (vertices_[static_cast<std::size_t>(here)].is_goal) break;
  }
  moves_ += steps_.size();
  return rollout_return;
}

int Rollout::DrawAction(const Actions& actions) {
  const auto moves = static_cast<std::int64_t>(actions.moves.size());
  const auto all = static_cast<std::int64_t>(actions.size());
  const double probability = options_.rollout_communication_probability;
  if (probability < 0.0 || moves == 0 || moves == all) {
    return static_cast<int>(random_.Uniform(0, all - 1));
  }
  if (probability > 0.0 && random_.Chance(probability)) {
    return static_cast<int>(random_.Uniform(moves, all - 1));
  }
  return static_cast<int>(random_.Uniform(0, moves - 1));
}

bool Rollout::CanGo(const Edge& edge, const PathState& path) {
  if (path.IsKnownFree(edge)) return true;
  Outcome& outcome = outcomes_[static_cast<std::size_t>(edge.uncertainty)];
  if (outcome.rollout != rollout_) outcome = {rollout_, random_.Chance(edge.feasibility)};
  return outcome.free;
}

double Rollout::Enter(VertexId from, VertexId vertex, const PathState& path) {
  const Vertex& entered = vertices_[static_cast<std::size_t>(vertex)];
  Visits& visits = visits_[static_cast<std::size_t>(vertex)];
  const int of_path = path.visits(vertex);
  const int earlier = visits.rollout == rollout_ ? visits.count : of_path;
  visits = {rollout_, earlier + 1};
  const double progress =
      vertices_[static_cast<std::size_t>(from)].steps_to_goal - entered.steps_to_goal;
  return entered.environment + entered.guidance_weight * log_.Of(++length_) +
         SmoothnessReward(earlier) + ProgressReward(progress, options_.reward);
}

Result<double> Rollout::Communicate(PathState& path, std::size_t view) {
  moves_ += steps_.size();
  const std::size_t steps = path.steps();
  for (const Edge* edge : steps_) {
    if (edge != nullptr) {
      path.Go(*edge);
    } else {
      path.Stay();
    }
  }
  Result<double> reward = information_.Of(path, view);
  if (reward) reward = CommunicationReward(path, *reward, options_.reward);
  path.TakeBack(steps);
  return reward;
}

}  // namespace conav::planner
