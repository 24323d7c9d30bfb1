#include "study/experiment/episode.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <set>
#include <utility>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"
#include "common/grid/visibility.h"
#include "operator/simulated/path_planner.h"
#include "planner/decision/robot_worker.h"

namespace conav::planner {
namespace {

constexpr double kControlStepS = 0.25;
constexpr std::uint64_t kNoticingSeed = 7;

std::map<std::string, std::string> NamesOf(const sim::WorldSpec& world) {
  std::map<std::string, std::string> names;
  for (std::size_t i = 1; i <= world.starts.size(); ++i) names[fmt::format("r{}", i)] = "w1";
  return names;
}

int TourMoves(const sim::WorldSpec& world, std::size_t robot) {
  std::set<Cell> walls;
  for (std::size_t i = 0; i < world.truth.size(); ++i) {
    const Cell cell = world.truth.CellAt(i);
    if (world.truth[cell] == Occupancy::kOccupied) walls.insert(cell);
  }
  const auto tour = operators::PathPlanner({}).Plan(ToBelief(world.truth), walls,
                                                    world.starts[robot], world.goals[robot]);
  DEMAND(tour.has_value());
  return static_cast<int>(tour->size()) - 1;
}

}  // namespace

double EstimatedLowLevelSteps(double moves, double turning_rad) {
  constexpr double kPerMove = 7.03;
  constexpr double kPerRadian = 3.73;
  return kPerMove * moves + kPerRadian * turning_rad;
}

int OptimalMoves(const sim::WorldSpec& world) {
  int moves = 0;
  for (std::size_t robot = 0; robot < world.starts.size(); ++robot) {
    moves += TourMoves(world, robot);
  }
  return moves;
}

CellWorld::CellWorld(const sim::WorldSpec& world,
                     const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                     EpisodeOptions options)
    : spec_(world),
      options_(std::move(options)),
      truth_(world.truth),
      open_doors_(world.doors),
      parameters_(person),
      person_(person, seed, NamesOf(world)),
      noticing_(DeriveSeed(seed, kNoticingSeed)) {
  belief_.world = "w1";
  belief_.wall_probability = ToBelief(world.human_map);
  belief_.cell_size_m = world.cell_size_m;
  result_.optimal_moves = OptimalMoves(world);
  for (std::size_t i = 0; i < world.starts.size(); ++i) {
    Robot& robot = robots_.emplace_back();
    robot.map.cell_size_m = world.cell_size_m;
    robot.map.cells = OccupancyGrid(truth_.rows(), truth_.columns(), Occupancy::kUnknown);
    RobotState& state = robot.state;
    state.world = belief_.world;
    state.robot = fmt::format("r{}", i + 1);
    state.grid = robot.map.geometry();
    state.cell = world.starts[i];
    state.goals_total = static_cast<std::uint32_t>(world.goals[i].size());
    (options_.marked_goals ? robot.unmarked : state.goals_left) = world.goals[i];
    state.path = {state.cell};
    result_.goals += static_cast<int>(world.goals[i].size());
    Look(robot);
  }
  person_.Receive(belief_);
  LetThePersonAct();
}

int CellWorld::Find(const std::string& name) const {
  const auto found = std::ranges::find(robots_, name, [](const Robot& r) { return r.state.robot; });
  return found == robots_.end() ? -1 : static_cast<int>(found - robots_.begin());
}

bool CellWorld::is_done() const {
  return std::ranges::all_of(robots_, [](const Robot& robot) {
    return robot.state.goals_left.empty() && robot.unmarked.empty();
  });
}

/// Another robot is there or on its way there.
bool CellWorld::IsHeld(Cell cell, int by_other_than) const {
  for (int i = 0; i < robot_count(); ++i) {
    const Robot& other = At(i);
    const bool enters = other.until && other.action.kind == CommandKind::kMove;
    if (i != by_other_than &&
        (other.state.cell == cell || (enters && other.action.target == cell))) {
      return true;
    }
  }
  return false;
}

void CellWorld::Begin(int robot, const Action& action) {
  DEMAND(!is_busy(robot));
  Robot& self = At(robot);
  RobotState& state = self.state;
  self.action = action;
  if (action.kind != CommandKind::kMove) return Start(self, 0.0, TurnTo(self, action.heading_rad));
  const Cell target = action.target;
  if (truth_[target] == Occupancy::kOccupied) {
    self.map.cells[target] = Occupancy::kOccupied;
    return Refuse(robot, CommandOutcome::kBlocked, target);
  }
  if (IsHeld(target, robot)) return Refuse(robot, CommandOutcome::kOccupied, target);
  Start(self, 1.0, TurnTo(self, HeadingTowards(state.cell, target)));
}

double CellWorld::TurnTo(Robot& robot, double heading_rad) {
  const double turn = std::abs(WrapAngle(heading_rad - robot.state.heading_rad));
  result_.turning_rad += turn;
  robot.state.heading_rad = heading_rad;
  return turn;
}

void CellWorld::Start(Robot& robot, double moves, double turning_rad) {
  const double steps = EstimatedLowLevelSteps(moves, turning_rad);
  robot.state.command_outcome = CommandOutcome::kRunning;
  robot.until = now_ + Seconds(kControlStepS * std::max(1.0, steps));
}

void CellWorld::Refuse(int robot, CommandOutcome outcome, Cell cell) {
  ++result_.blocked;
  At(robot).state.command_outcome = outcome;
  At(robot).state.command_cell = cell;
}

void CellWorld::Advance(SimTime latest) {
  int next = -1;
  for (int i = 0; i < robot_count(); ++i) {
    if (is_busy(i) && (next < 0 || At(i).until < At(next).until)) next = i;
  }
  if (next < 0 || *At(next).until > latest) {
    now_ = std::max(now_, latest);
  } else {
    now_ = *At(next).until;
    End(next);
  }
  for (Robot& robot : robots_) robot.state.stamp = now_;
}

void CellWorld::End(int robot) {
  Robot& self = At(robot);
  RobotState& state = self.state;
  self.until.reset();
  state.stamp = now_;
  state.command_outcome = CommandOutcome::kDone;
  result_.time_s = now_.ToSeconds();
  if (self.action.kind != CommandKind::kMove) return Send(self);
  state.cell = self.action.target;
  state.path.push_back(state.cell);
  ++state.cell_moves;
  ++result_.moves;
  result_.trajectory.push_back(state.cell);
  CloseDoors();
  Look(self);
  ClaimGoal(self);
  if (options_.streams) Stream(self, static_cast<int>(EstimatedLowLevelSteps(1.0, 0.0)));
}

void CellWorld::CloseDoors() {
  std::erase_if(open_doors_, [&](const sim::Door& door) {
    if (result_.moves < door.after_moves || IsHeld(door.cell, -1)) return false;
    truth_[door.cell] = Occupancy::kOccupied;
    return true;
  });
}

void CellWorld::Look(Robot& robot) {
  const VisibleCells seen = CastRange(truth_, robot.state.cell, options_.range_cells);
  for (const Cell cell : seen.free) robot.map.cells[cell] = Occupancy::kFree;
  for (const Cell cell : seen.walls) robot.map.cells[cell] = Occupancy::kOccupied;
}

void CellWorld::ClaimGoal(Robot& robot) {
  RobotState& state = robot.state;
  if (std::erase(state.goals_left, state.cell) > 0) state.goals_reached.push_back(state.cell);
}

Snapshot CellWorld::MakeSnapshot(Robot& robot) const {
  const RobotState& state = robot.state;
  Snapshot snapshot;
  snapshot.stamp = state.stamp;
  snapshot.world = state.world;
  snapshot.robot = state.robot;
  snapshot.grid = state.grid;
  snapshot.cell = state.cell;
  snapshot.heading_rad = state.heading_rad;
  snapshot.width = static_cast<std::uint32_t>(lens_.width);
  snapshot.height = static_cast<std::uint32_t>(lens_.height);
  snapshot.horizontal_fov_rad = lens_.horizontal_fov_rad;
  snapshot.visible =
      CastView(truth_, ViewThrough(lens_, state.cell, state.heading_rad, spec_.cell_size_m));
  return snapshot;
}

void CellWorld::Send(Robot& robot) {
  RobotState& state = robot.state;
  Snapshot snapshot = MakeSnapshot(robot);
  snapshot.sequence_number = ++state.snapshots;
  snapshot.path = std::exchange(state.path, {state.cell});
  if (options_.marked_goals) Mark(robot, snapshot);
  snapshot.goals_left = state.goals_left;
  ++state.images;
  ++result_.snapshots;
  robot.picture = snapshot;
  person_.Receive(state);
  person_.Receive(snapshot, clock_.Now());
  LetThePersonAct();
}

void CellWorld::Stream(Robot& robot, int steps) {
  Snapshot snapshot = MakeSnapshot(robot);
  snapshot.streamed = true;
  snapshot.path = std::exchange(robot.state.path, {robot.state.cell});
  for (int step = 0; step < steps; ++step) {
    snapshot.sequence_number = ++robot.state.snapshots;
    ++robot.state.images;
    ++result_.snapshots;
    person_.Receive(snapshot, clock_.Now());
    snapshot.path = {robot.state.cell};
  }
  LetThePersonAct();
}

void CellWorld::Mark(Robot& robot, const Snapshot& snapshot) {
  if (parameters_.silent) return;
  const auto noticed =
      operators::NoticedGoals(parameters_.reader, snapshot, robot.unmarked, noticing_);
  for (const Cell goal : noticed) {
    std::erase(robot.unmarked, goal);
    robot.state.goals_left.push_back(goal);
  }
  ClaimGoal(robot);
}

void CellWorld::Ask(const AttentionRequest& request) {
  person_.Receive(request, clock_.Now());
  LetThePersonAct();
}

/// The person's requests, answered as the operator service does, until they have none left.
void CellWorld::LetThePersonAct() {
  for (const Robot& robot : robots_) person_.Receive(robot.state);
  while (const auto ask = person_.Next(clock_.Now())) {
    const auto* edit = std::get_if<EditRequest>(&ask->body);
    const std::uint64_t revision =
        edit != nullptr ? Edit(*edit) : Guide(std::get<GuideRequest>(ask->body));
    person_.Answered(OperatorReply{.accepted = true, .revision = revision}, clock_.Now());
  }
}

std::uint64_t CellWorld::Edit(const EditRequest& request) {
  for (const CellEdit& edit : request.edits) {
    belief_.wall_probability[edit.cell] = edit.wall ? 1.0F : 0.0F;
  }
  result_.edits += static_cast<int>(request.edits.size());
  ++belief_.revision;
  person_.Receive(belief_);
  return belief_.revision;
}

std::uint64_t CellWorld::Guide(const GuideRequest& request) {
  Robot& robot = At(Find(request.robot));
  Guidance guidance;
  guidance.stamp = now_;
  guidance.world = belief_.world;
  guidance.robot = request.robot;
  guidance.revision = robot.guidance ? robot.guidance->revision + 1 : 1;
  guidance.path = request.path;
  guidance.answers_snapshot = request.answers_snapshot;
  guidance.valid_until = now_ + Seconds(request.valid_for_s);
  robot.guidance = guidance;
  ++result_.guidance;
  person_.Receive(guidance);
  return guidance.revision;
}

EpisodeResult CellWorld::Result() const {
  EpisodeResult result = result_;
  result.all_goals = is_done();
  for (const Robot& robot : robots_) {
    result.goals_reached += static_cast<int>(robot.state.goals_reached.size());
  }
  result.mapping_accuracy = CompareMaps(truth_, spec_.human_map, belief_.wall_probability).mapping;
  return result;
}

namespace {

/// A robot that waits, or asks a person, goes on within this time or never.
constexpr double kIdleLimitS = 300.0;
constexpr DecisionGate::Timeouts kTimeouts{std::chrono::seconds(5), std::chrono::seconds(5)};

double ThreadMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Passes a method on to a worker, and counts.
class WatchedMethod final : public Method {
 public:
  WatchedMethod(Method& method, const SituationListener& listener, EpisodeResult& counts)
      : method_(method), listener_(listener), counts_(counts) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override {
    if (listener_) listener_(situation);
    const double start = ThreadMilliseconds();
    Decision decision = method_.Decide(situation, stop);
    counts_.decision_ms.push_back(ThreadMilliseconds() - start);
    counts_.perception_queries += decision.report.perception_queries;
    counts_.perception_cached += decision.report.perception_cached;
    return decision;
  }
  void Prepare(const OccupancyGrid& map) override { method_.Prepare(map); }
  std::vector<Cell> IntendedPathFor(const Situation& situation) override {
    return method_.IntendedPathFor(situation);
  }
  AwaitedInput awaits() const override { return method_.awaits(); }

 private:
  Method& method_;
  const SituationListener& listener_;
  EpisodeResult& counts_;
};

/// The planner of one episode.
class Run {
 public:
  Run(CellWorld& world, const EpisodeDriver& driver, std::uint64_t seed)
      : world_(world), driver_(driver), board_(Names()) {
    for (int robot = 0; robot < world_.robot_count(); ++robot) {
      RobotWorker::Options options{.robot = world_.state(robot).robot,
                                   .method_name = "",
                                   .timeouts = kTimeouts,
                                   .command_ttl = std::chrono::hours(1),
                                   .seed = DeriveSeed(seed, static_cast<std::uint64_t>(robot)),
                                   .goal_knowledge = driver.goal_knowledge};
      workers_.push_back(std::make_unique<RobotWorker>(
          std::move(options),
          std::make_unique<WatchedMethod>(*driver.methods[static_cast<std::size_t>(robot)],
                                          driver_.listener, counts_),
          board_, driver.clock, OutputsOf(robot)));
      commands_.emplace_back();
      board_.PutLens(world_.state(robot).robot, CameraLens{});
    }
  }

  EpisodeResult Play(int action_limit) {
    SimTime idle_since = world_.now();
    while (!world_.is_done() && actions_ < action_limit) {
      const int actions = actions_;
      const Clock::TimePoint again = StepAll();
      if (actions_ != actions || IsAnyBusy()) idle_since = world_.now();
      if (actions_ != actions && !IsAnyBusy()) continue;
      if (world_.now() > idle_since + Seconds(kIdleLimitS)) break;
      const SimTime before = world_.now();
      world_.Advance(before + (again - driver_.clock.Now()));
      driver_.clock.Advance(
          std::chrono::nanoseconds(world_.now().nanoseconds - before.nanoseconds));
    }
    EpisodeResult result = world_.Result();
    result.action_limit = action_limit;
    result.decision_ms = std::move(counts_.decision_ms);
    result.perception_queries = counts_.perception_queries;
    result.perception_cached = counts_.perception_cached;
    return result;
  }

 private:
  std::map<std::string, std::string> Names() const {
    std::map<std::string, std::string> names;
    for (int i = 0; i < world_.robot_count(); ++i) {
      names[world_.state(i).robot] = world_.world_name();
    }
    return names;
  }

  bool IsAnyBusy() const {
    for (int i = 0; i < world_.robot_count(); ++i) {
      if (world_.is_busy(i)) return true;
    }
    return false;
  }

  RobotWorker::Outputs OutputsOf(int robot) {
    RobotWorker::Outputs outputs;
    outputs.command = [this, robot](const RobotCommand& command) {
      commands_[static_cast<std::size_t>(robot)] = command;
      ++actions_;
      Action action{.kind = command.kind, .heading_rad = command.heading_rad};
      if (command.kind == CommandKind::kMove) {
        action.target = world_.state(robot).grid.PositionToCell(command.path.back());
      }
      world_.Begin(robot, action);
    };
    outputs.attention = [this](const AttentionRequest& request) {
      if (request.reason != AttentionReason::kNone) world_.Ask(request);
    };
    outputs.report = [](const SearchReport&) {};
    outputs.plan = [](const RobotState&, const MapUpdate&, const std::vector<Cell>&) {};
    return outputs;
  }

  void PutAll() {
    board_.Put(world_.belief());
    for (int i = 0; i < world_.robot_count(); ++i) {
      RobotState state = world_.state(i);
      const RobotCommand& command = commands_[static_cast<std::size_t>(i)];
      state.command_sequence_number = command.sequence_number;
      state.lease_epoch = command.lease_epoch;
      board_.PutMap(state.robot, world_.map(i));
      if (world_.guidance(i)) board_.Put(*world_.guidance(i));
      board_.Put(std::move(state));
    }
  }

  /// The turns of all robots that carry out nothing; when the first of them wants another.
  Clock::TimePoint StepAll() {
    Clock::TimePoint again = driver_.clock.Now() + Seconds(kIdleLimitS);
    for (int i = 0; i < world_.robot_count(); ++i) {
      PutAll();
      if (world_.is_busy(i)) continue;
      const Clock::TimePoint next = workers_[static_cast<std::size_t>(i)]->Step(StopToken());
      if (next > driver_.clock.Now()) again = std::min(again, next);
    }
    return again;
  }

  CellWorld& world_;
  const EpisodeDriver& driver_;
  Blackboard board_;
  std::vector<std::unique_ptr<RobotWorker>> workers_;
  std::vector<RobotCommand> commands_;  // newest, by robot
  EpisodeResult counts_;
  int actions_ = 0;
};

}  // namespace

EpisodeResult RunEpisode(const sim::WorldSpec& world, const EpisodeDriver& driver,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options) {
  CellWorld cells(world, person, seed, options);
  DEMAND(driver.methods.size() == world.starts.size());
  return Run(cells, driver, seed).Play(options.action_limit * cells.robot_count());
}

EpisodeResult RunEpisode(const sim::WorldSpec& world, Method& method,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options, const SituationListener& listener) {
  sim::WorldSpec alone = world;
  alone.starts.resize(1);
  alone.goals.resize(1);
  FakeClock clock;
  return RunEpisode(alone,
                    EpisodeDriver{.methods = {&method}, .clock = clock, .listener = listener},
                    person, seed, options);
}

}  // namespace conav::planner
