#include "planner/search/rollout.h"

namespace conav::planner {
namespace {

constexpr int kStayed = -1;

const LogTable& SharedLogTable() {
  static const LogTable table;
  return table;
}

std::size_t Index(int number) { return static_cast<std::size_t>(number); }

}  // namespace

Rollout::Rollout(const SearchOptions& options, const PathState& path, const OfferedActions& offered,
                 ViewInformation& information, Random& random)
    : options_(options),
      offered_(offered),
      information_(information),
      draws_(random.Next()),
      log_(SharedLogTable()),
      visits_(path.vertex_count()),
      outcomes_(path.uncertainty_count()),
      steps_(Index(options.rollout_depth)) {
  vertices_.reserve(path.vertex_count());
  moves_.reserve(offered.edges().size());
  for (std::size_t i = 0; i < path.vertex_count(); ++i) {
    AddVertex(path, static_cast<VertexId>(i));
  }
}

void Rollout::AddVertex(const PathState& path, VertexId vertex) {
  const Actions actions = offered_.At(vertex);
  const bool guides = path.guided_before() && !path.IsGuidance(vertex);
  vertices_.push_back({static_cast<int>(moves_.size()), static_cast<int>(actions.moves.size()),
                       actions.size(), path.IsGoal(vertex), guides ? -1.0 : 0.0});
  for (const Edge& edge : actions.moves) {
    moves_.push_back({edge.target, edge.uncertainty, BitsBelow(edge.feasibility),
                      path.StepsToGoal(vertex) - path.StepsToGoal(edge.target)});
  }
}

Result<double> Rollout::Run(PathState& path) {
  ++rollout_;
  sent_information_ = kNoView;
  const int length = path.length();
  VertexId here = path.vertex();
  double rollout_return = 0.0;
  double weight = 1.0;  // gamma^t
  int t = 0;
  while (t < options_.rollout_depth) {
    const Vertex& at = vertices_[Index(here)];
    if (at.actions == 0) break;
    const SplitMix64::Halves draw = draws_.NextHalves();
    const auto action =
        static_cast<int>(ScaledTo(draw.upper, static_cast<std::uint32_t>(at.actions)));
    if (action >= at.moves) {
      const auto reward = Communicate(path, Index(action - at.moves), t);
      if (!reward) return reward;
      return rollout_return + weight * *reward;
    }
    const Move& move = moves_[Index(at.first_move + action)];
    const bool goes = CanGo(move, draw.lower, path);
    steps_[Index(t)] = goes ? at.first_move + action : kStayed;
    here = goes ? move.target : here;
    ++t;
    rollout_return += weight * Enter(here, goes ? move.steps_saved : 0.0, length + t, path);
    weight *= options_.discount;
    if (vertices_[Index(here)].is_goal) break;
  }
  steps_made_ = t;
  moves_made_ += static_cast<std::uint64_t>(t);
  return rollout_return;
}

/// Without branches, because the outcome is random.
bool Rollout::CanGo(const Move& move, std::uint32_t bits, const PathState& path) {
  Outcome& outcome = outcomes_[Index(move.uncertainty)];
  const std::uint32_t drawn = bits < move.free_below ? 1 : 0;
  outcome.is_free = outcome.rollout == rollout_ ? outcome.is_free : drawn;
  outcome.rollout = rollout_;
  return (outcome.is_free | static_cast<std::uint32_t>(path.HasPassed(move.uncertainty))) != 0;
}

double Rollout::Enter(VertexId vertex, double steps_saved, int length, const PathState& path) {
  const Vertex& entered = vertices_[Index(vertex)];
  Visits& visits = visits_[Index(vertex)];
  const int earlier = visits.rollout == rollout_ ? visits.count : path.visits(vertex);
  visits = {rollout_, earlier + 1};
  const double guidance = entered.guidance_weight * log_.Of(length);
  return MoveTerms(entered.is_goal, guidance, earlier, steps_saved, options_.reward).Sum();
}

void Rollout::Repeat(int t, PathState& path) const {
  const int move = steps_[Index(t)];
  if (move == kStayed) {
    path.Stay();
  } else {
    path.Go(offered_.edges()[Index(move)]);
  }
}

Result<double> Rollout::Communicate(PathState& path, std::size_t view, int steps) {
  steps_made_ = steps;
  moves_made_ += static_cast<std::uint64_t>(steps);
  const std::size_t before = path.steps();
  for (int t = 0; t < steps; ++t) Repeat(t, path);
  Result<double> reward = information_.Of(path, view);
  if (reward) {
    sent_information_ = *reward;
    sent_heading_rad_ = path.ViewHeading(offered_.At(path.vertex()).views[view]);
    reward = RewardOfSnapshot(path, sent_heading_rad_, sent_information_, options_.reward).Sum();
  }
  if (reward && options_.optional_pictures && *reward < 0.0) {
    sent_information_ = kNoView;
    reward = 0.0;
  }
  path.TakeBack(before);
  return reward;
}

RewardTerms Rollout::Terms(PathState& path) const {
  RewardTerms terms;
  double weight = 1.0;  // gamma^t
  const std::size_t before = path.steps();
  for (int t = 0; t < steps_made_; ++t) {
    Repeat(t, path);
    terms += weight * MoveTerms(path, options_.reward);
    weight *= options_.discount;
  }
  if (sent_information_ != kNoView) {
    terms += weight *
             RewardOfSnapshot(path, sent_heading_rad_, sent_information_, options_.reward).Terms();
  }
  path.TakeBack(before);
  return terms;
}

}  // namespace conav::planner
