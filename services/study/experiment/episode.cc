#include <cmath>
#include <ctime>
#include <utility>

#include "common/grid/geometry.h"
#include "common/grid/visibility.h"
#include "operator/simulated/path_planner.h"
#include "study/experiment/search_experiment.h"

namespace conav::planner {
namespace {

constexpr std::chrono::seconds kActionTime{1};

double ThreadMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

class Episode {
 public:
  Episode(const sim::WorldSpec& world, Method& method,
          const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
          const EpisodeOptions& options)
      : world_(world),
        method_(method),
        options_(options),
        person_(person, seed, {{robot_name_, world_name_}}) {
    now_.state.world = world_name_;
    now_.state.robot = robot_name_;
    now_.state.cell = world.starts.front();
    now_.state.goals_left = world.goals.front();
    now_.state.goals_total = static_cast<std::uint32_t>(world.goals.front().size());
    now_.state.path = {now_.state.cell};
    now_.map.cell_size_m = world.cell_size_m;
    now_.map.cells = OccupancyGrid(world.truth.rows(), world.truth.columns(), Occupancy::kUnknown);
    now_.belief.world = world_name_;
    now_.belief.wall_probability = ToBelief(world.human_map);
    result_.goals = static_cast<int>(world.goals.front().size());
    result_.optimal_moves = OptimalMoves(world);
    Look();
    person_.Receive(now_.belief);
    LetThePersonAct();
  }

  EpisodeResult Run(const SituationListener& listener) {
    for (int i = 0; i < options_.action_limit && !now_.state.goals_left.empty(); ++i) {
      if (listener) listener(now_);
      if (!Turn()) break;
    }
    result_.all_goals = now_.state.goals_left.empty();
    result_.goals_reached = static_cast<int>(now_.state.goals_reached.size());
    result_.mapping_accuracy =
        CompareMaps(world_.truth, world_.human_map, now_.belief.wall_probability).mapping;
    return std::move(result_);
  }

 private:
  /// One decision and what it leads to; false when the robot waits and nobody will change that.
  bool Turn() {
    const double start = ThreadMilliseconds();
    const Decision decision = method_.Decide(now_, StopToken());
    result_.decision_ms.push_back(ThreadMilliseconds() - start);
    result_.perception_queries += decision.report.perception_queries;
    result_.perception_cached += decision.report.perception_cached;
    now_.state.stamp = now_.state.stamp + kActionTime;
    if (!decision.action) return decision.attention && Ask(decision);
    if (decision.action->kind == CommandKind::kMove) {
      Move(decision.action->target);
    } else {
      Send(decision.action->heading_rad);
    }
    return true;
  }

  void Move(Cell target) {
    if (world_.truth[target] == Occupancy::kOccupied) {
      now_.map.cells[target] = Occupancy::kOccupied;
      ++result_.blocked;
      return;
    }
    RobotState& state = now_.state;
    TurnTo(HeadingTowards(state.cell, target));
    state.cell = target;
    state.path.push_back(target);
    ++state.cell_moves;
    ++result_.moves;
    result_.trajectory.push_back(target);
    if (std::erase(state.goals_left, target) > 0) state.goals_reached.push_back(target);
    Look();
  }

  void Look() {
    const VisibleCells seen = CastRange(world_.truth, now_.state.cell, options_.range_cells);
    for (const Cell cell : seen.free) now_.map.cells[cell] = Occupancy::kFree;
    for (const Cell cell : seen.walls) now_.map.cells[cell] = Occupancy::kOccupied;
  }

  void TurnTo(double heading_rad) {
    RobotState& state = now_.state;
    result_.turning_rad += std::abs(WrapAngle(heading_rad - state.heading_rad));
    state.heading_rad = heading_rad;
  }

  void Send(double heading_rad) {
    RobotState& state = now_.state;
    TurnTo(heading_rad);
    Snapshot snapshot;
    snapshot.stamp = state.stamp;
    snapshot.world = world_name_;
    snapshot.robot = robot_name_;
    snapshot.sequence_number = ++state.snapshots;
    snapshot.cell = state.cell;
    snapshot.heading_rad = heading_rad;
    snapshot.width = static_cast<std::uint32_t>(now_.lens.width);
    snapshot.height = static_cast<std::uint32_t>(now_.lens.height);
    snapshot.horizontal_fov_rad = now_.lens.horizontal_fov_rad;
    snapshot.visible =
        CastView(world_.truth, ViewThrough(now_.lens, state.cell, heading_rad, world_.cell_size_m));
    snapshot.path = std::exchange(state.path, {state.cell});
    snapshot.goals_left = state.goals_left;
    ++state.images;
    ++result_.snapshots;
    person_.Receive(now_.state);
    person_.Receive(snapshot, clock_.Now());
    LetThePersonAct();
  }

  /// The robot waits for the operator; false when they do nothing about it.
  bool Ask(const Decision& decision) {
    const int before = result_.guidance + result_.edits;
    AttentionRequest request;
    request.stamp = now_.state.stamp;
    request.world = world_name_;
    request.robot = robot_name_;
    request.sequence_number = ++asked_;
    request.reason = *decision.attention;
    request.cell = decision.attention_cell;
    request.newest_snapshot = now_.state.snapshots;
    person_.Receive(request, clock_.Now());
    LetThePersonAct();
    return result_.guidance + result_.edits > before;
  }

  /// The person's requests, answered as the operator service does, until they have none left.
  void LetThePersonAct() {
    person_.Receive(now_.state);
    while (const auto ask = person_.Next(clock_.Now())) {
      const auto* edit = std::get_if<EditRequest>(&ask->body);
      const std::uint64_t revision =
          edit != nullptr ? Edit(*edit) : Guide(std::get<GuideRequest>(ask->body));
      person_.Answered(OperatorReply{.accepted = true, .revision = revision}, clock_.Now());
    }
  }

  std::uint64_t Edit(const EditRequest& request) {
    for (const CellEdit& edit : request.edits) {
      now_.belief.wall_probability[edit.cell] = edit.wall ? 1.0F : 0.0F;
    }
    result_.edits += static_cast<int>(request.edits.size());
    ++now_.belief.revision;
    person_.Receive(now_.belief);
    return now_.belief.revision;
  }

  std::uint64_t Guide(const GuideRequest& request) {
    Guidance guidance;
    guidance.stamp = now_.state.stamp;
    guidance.world = world_name_;
    guidance.robot = robot_name_;
    guidance.revision = static_cast<std::uint64_t>(++result_.guidance);
    guidance.path = request.path;
    guidance.answers_snapshot = request.answers_snapshot;
    guidance.valid_until = now_.state.stamp + Seconds(request.valid_for_s);
    now_.guided_before = true;
    now_.guidance = guidance;
    person_.Receive(guidance);
    return guidance.revision;
  }

  const std::string world_name_ = "w1";
  const std::string robot_name_ = "r1";
  const sim::WorldSpec& world_;
  Method& method_;
  EpisodeOptions options_;
  FakeClock clock_;  // the person's: nobody waits here
  operators::SyntheticOperator person_;
  Situation now_;
  EpisodeResult result_;
  std::uint64_t asked_ = 0;
};

}  // namespace

double EstimatedLowLevelSteps(double moves, double turning_rad) {
  constexpr double kPerMove = 7.03;
  constexpr double kPerRadian = 3.73;
  return kPerMove * moves + kPerRadian * turning_rad;
}

EpisodeResult RunEpisode(const sim::WorldSpec& world, Method& method,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options, const SituationListener& listener) {
  return Episode(world, method, person, seed, options).Run(listener);
}

int OptimalMoves(const sim::WorldSpec& world) {
  std::set<Cell> walls;
  for (std::size_t i = 0; i < world.truth.size(); ++i) {
    const Cell cell = world.truth.CellAt(i);
    if (world.truth[cell] == Occupancy::kOccupied) walls.insert(cell);
  }
  const auto tour = operators::PathPlanner({}).Plan(ToBelief(world.truth), walls,
                                                    world.starts.front(), world.goals.front());
  DEMAND(tour.has_value());
  return static_cast<int>(tour->size()) - 1;
}

}  // namespace conav::planner
