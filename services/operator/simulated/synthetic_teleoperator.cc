#include "operator/simulated/synthetic_teleoperator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

/// Cells off the middle of its own within which a robot that bumped is free again.
constexpr double kBackInTheMiddle = 0.2;
/// Steps that a way around another robot may be longer, before that one has to make room.
constexpr std::size_t kDetour = 8;

}  // namespace

SyntheticTeleoperator::SyntheticTeleoperator(
    const SyntheticOperatorParameters& parameters, std::uint64_t seed,
    const std::map<std::string, std::string>& world_of_robot)
    : parameters_(parameters), random_(seed) {
  // An operator who misleads on purpose does so by the paths that they draw.
  if (parameters_.planner.horizon == "away") parameters_.planner.horizon = "tour";
  for (const auto& [name, world] : world_of_robot) {
    robots_[name].world = world;
    worlds_[world];
  }
}

// --- hearing ---------------------------------------------------------------------------------

SyntheticTeleoperator::Robot* SyntheticTeleoperator::Find(const std::string& name,
                                                          const std::string& world) {
  const auto found = robots_.find(name);
  return found != robots_.end() && found->second.world == world ? &found->second : nullptr;
}

void SyntheticTeleoperator::Receive(const Belief& belief) {
  const auto world = worlds_.find(belief.world);
  if (world == worlds_.end()) return;
  // A service that lost its database starts over at 0; then its map is the one that counts.
  if (belief.revision == 0) world->second.revision_needed = 0;
  const BeliefGrid& map = belief.wall_probability;
  const auto& old = world->second.belief;
  if (!old || old->wall_probability.rows() != map.rows() ||
      old->wall_probability.columns() != map.columns()) {
    world->second.seen.emplace(map.rows(), map.columns());
  }
  world->second.belief = belief;
}

void SyntheticTeleoperator::ReceiveCellSize(const std::string& world, double cell_size_m) {
  const auto found = worlds_.find(world);
  if (found != worlds_.end()) found->second.cell_size_m = cell_size_m;
}

void SyntheticTeleoperator::Receive(const RobotState& state) {
  Robot* robot = Find(state.robot, state.world);
  if (robot == nullptr) return;
  // A new run of the simulator: the person starts again for this robot.
  if (robot->state && state.stamp < robot->state->stamp) {
    *robot = Robot{};
    robot->world = state.world;
  }
  robot->state = state;
}

void SyntheticTeleoperator::Receive(const Snapshot& snapshot) {
  Robot* robot = Find(snapshot.robot, snapshot.world);
  if (robot == nullptr || snapshot.sequence_number <= robot->newest_snapshot) return;
  robot->newest_snapshot = snapshot.sequence_number;
  robot->unseen.push_back(snapshot);
  robot->unseen.back().jpeg.clear();
}

std::size_t SyntheticTeleoperator::open() const {
  return static_cast<std::size_t>(std::count_if(
      robots_.begin(), robots_.end(), [](const auto& entry) { return !entry.second.finished(); }));
}

GridGeometry SyntheticTeleoperator::GeometryOf(const Robot& robot) const {
  const World& world = worlds_.at(robot.world);
  const BeliefGrid& map = world.belief->wall_probability;
  return {map.rows(), map.columns(), world.cell_size_m, world.belief->middle};
}

// --- whether and what came of it -------------------------------------------------------------

bool SyntheticTeleoperator::Ready(const Robot& robot, Clock::TimePoint now) const {
  const World& world = worlds_.at(robot.world);
  if (!robot.state || !world.belief || world.cell_size_m <= 0.0) return false;
  if (world.belief->revision < world.revision_needed) return false;
  const bool carried_out = robot.order == 0 || robot.state->drive_order == robot.order;
  const bool running = robot.state->command_outcome == CommandOutcome::kRunning;
  const bool shown = robot.newest_snapshot >= robot.state->snapshots;
  if (carried_out && !running && shown) return true;
  return now >= robot.ordered_at + Seconds(parameters_.patience_s);
}

void SyntheticTeleoperator::Judge(const std::string& name, Robot& robot) {
  const RobotState& state = *robot.state;
  if (robot.order == 0 || state.drive_order != robot.order || robot.judged_order == robot.order) {
    return;
  }
  robot.judged_order = robot.order;
  if (state.command_outcome == CommandOutcome::kBlocked) {
    ++counts_.bumps;
    WorldOf(robot).seen->Bump(state.command_cell);
    robot.to_centre = true;
    Refresh(robot);
  } else if (state.command_outcome == CommandOutcome::kOccupied) {
    Refresh(robot);
    SendForRoom(name, robot);
  }
}

// --- looking and planning --------------------------------------------------------------------

void SyntheticTeleoperator::Look(Robot& robot) {
  StreamMemory& seen = *WorldOf(robot).seen;
  const auto delay = static_cast<std::size_t>(parameters_.steering.reaction_steps);
  while (robot.unseen.size() > delay) {
    seen.Look(parameters_.reader, robot.unseen.front(), random_);
    robot.unseen.pop_front();
  }
}

std::optional<OperatorAsk> SyntheticTeleoperator::MaybeEdit(const Robot& robot) {
  const World& world = WorldOf(robot);
  EditRequest request{world.belief->revision, world.seen->Errors(world.belief->wall_probability,
                                                                 parameters_.reader.edit_limit)};
  if (request.edits.empty() || !random_.Chance(parameters_.steering.edit_probability)) {
    return std::nullopt;
  }
  return OperatorAsk{robot.world, robot.state->stamp, request};
}

ShownPose SyntheticTeleoperator::PoseNow(const Robot& robot) const {
  if (robot.poses.empty()) return {robot.state->position, robot.state->heading_rad};
  ShownPose pose = robot.poses.front();
  for (const DriveAction key : robot.keys) pose = Expect(parameters_.steering, pose, key);
  return pose;
}

void SyntheticTeleoperator::Refresh(Robot& robot) {
  robot.poses.clear();
  robot.keys.clear();
}

std::set<Cell> SyntheticTeleoperator::CellsOfOthers(const std::string& name,
                                                    const std::string& world) const {
  std::set<Cell> cells;
  for (const auto& [other_name, other] : robots_) {
    if (other_name != name && other.world == world && other.state) cells.insert(other.state->cell);
  }
  return cells;
}

std::vector<Cell> SyntheticTeleoperator::PlanPath(const Robot& robot, Cell start,
                                                  const std::set<Cell>& obstacles,
                                                  const std::vector<Cell>& goals) const {
  const World& world = worlds_.at(robot.world);
  const auto path =
      PathPlanner(parameters_.planner)
          .Plan(world.seen->Over(world.belief->wall_probability), obstacles, start, goals);
  return path ? *path : std::vector<Cell>{start};
}

/// The cell that the robot is believed to be in.
Cell SyntheticTeleoperator::CellNow(const Robot& robot, const std::set<Cell>& walls) const {
  const Cell cell = GeometryOf(robot).PositionToCell(PoseNow(robot).position);
  const bool inside = worlds_.at(robot.world).belief->wall_probability.Contains(cell);
  return inside && !walls.contains(cell) ? cell : robot.state->cell;
}

/// The cells to steer along, from the robot's own on. Sends another robot on a task where that
/// is what has to happen first; then the path is empty.
std::vector<Cell> SyntheticTeleoperator::PathFor(const std::string& name, Robot& robot) {
  World& world = WorldOf(robot);
  const bool task = !tasks_.empty() && tasks_.front().robot == name;
  const std::vector<Cell> goals =
      task ? std::vector<Cell>{tasks_.front().cell} : robot.state->goals_left;
  if (goals.empty()) return {};
  const std::set<Cell> walls = world.seen->Walls();
  const std::set<Cell> others = CellsOfOthers(name, robot.world);
  const Cell start = CellNow(robot, walls);
  std::set<Cell> obstacles = walls;
  obstacles.insert(others.begin(), others.end());
  obstacles.erase(start);
  std::vector<Cell> path = PlanPath(robot, start, obstacles, goals);
  const std::vector<Cell> direct = PlanPath(robot, start, walls, goals);
  const bool leads_there = path.size() > 1 || start == goals.front();
  if (!leads_there && direct.size() == 1) {
    world.seen->ForgetWalls();  // something was mistaken for a wall: look again
    return {start};
  }
  if (leads_there && path.size() <= direct.size() + kDetour) return path;
  const auto blocked = std::find_if(direct.begin() + 1, direct.end(),
                                    [&](Cell cell) { return others.contains(cell); });
  if (blocked == direct.end()) return path;
  if (AskForRoom(name, robot, direct, *blocked)) return {};
  if (leads_there) return path;
  SendAnywhere(robot);
  return {};
}

// --- pressing keys ---------------------------------------------------------------------------

DriveAction SyntheticTeleoperator::Press(Robot& robot, DriveAction meant) {
  const SteeringParameters& steering = parameters_.steering;
  DriveAction key = meant;
  const bool changes = robot.last_key != DriveAction::kStop && robot.last_key != meant;
  if (changes && random_.Chance(steering.overshoot_probability)) key = robot.last_key;
  if (random_.Chance(steering.slip_probability)) {
    key = static_cast<DriveAction>(random_.Uniform(static_cast<int>(DriveAction::kForward),
                                                   static_cast<int>(DriveAction::kTurnRight)));
  }
  robot.last_key = key;
  return key;
}

OperatorAsk SyntheticTeleoperator::Order(const std::string& name, Robot& robot, DriveAction key,
                                         Clock::TimePoint now) {
  robot.poses.push_back({robot.state->position, robot.state->heading_rad});
  robot.keys.push_back(key);
  const auto delay = static_cast<std::size_t>(parameters_.steering.reaction_steps);
  while (robot.poses.size() > delay) {
    robot.poses.pop_front();
    robot.keys.pop_front();
  }
  robot.ordered_at = now;
  SimTime newest;
  for (const auto& [other_name, other] : robots_) {
    if (other.world == robot.world && other.state) newest = std::max(newest, other.state->stamp);
  }
  const SimTime expires_at =
      newest + std::chrono::nanoseconds(
                   SimTime::FromSeconds(parameters_.steering.order_valid_s).nanoseconds);
  return {robot.world, robot.state->stamp, DriveRequest{name, key, expires_at}};
}

bool SyntheticTeleoperator::KnowsAll() const {
  return std::all_of(robots_.begin(), robots_.end(), [&](const auto& entry) {
    const World& world = worlds_.at(entry.second.world);
    return entry.second.state && world.belief && world.cell_size_m > 0.0;
  });
}

std::optional<OperatorAsk> SyntheticTeleoperator::Next(Clock::TimePoint now) {
  if (under_way_ || parameters_.silent || now < not_before_ || !KnowsAll()) return std::nullopt;
  if ((under_way_ = Again())) return under_way_;
  // A robot that has to wait for another one may lead from one to the next.
  for (std::size_t round = 0; !under_way_ && round <= robots_.size() + 1; ++round) {
    const std::string name = Choose();
    if (name.empty() || !Ready(robots_.at(name), now)) return std::nullopt;
    under_way_ = AskFor(name, now);
  }
  return under_way_;
}

std::optional<OperatorAsk> SyntheticTeleoperator::Again() {
  std::optional<OperatorAsk> ask = std::exchange(refused_, std::nullopt);
  if (!ask) return std::nullopt;
  const Robot& robot = robots_.at(std::get<DriveRequest>(ask->body).robot);
  return robot.state && robot.state->stamp == ask->stamp ? ask : std::nullopt;
}

/// What to ask for the sake of this robot; nothing when another one has to be steered first.
std::optional<OperatorAsk> SyntheticTeleoperator::AskFor(const std::string& name,
                                                         Clock::TimePoint now) {
  Robot& robot = robots_.at(name);
  if (std::exchange(steered_, name) != name) Refresh(robot);
  const std::size_t tasks = tasks_.size();
  Judge(name, robot);
  if (tasks_.size() != tasks) return std::nullopt;
  Look(robot);
  if (auto edit = MaybeEdit(robot)) return edit;
  const std::vector<Cell> path = PathFor(name, robot);
  if (path.empty()) return std::nullopt;
  const GridGeometry geometry = GeometryOf(robot);
  const ShownPose pose = PoseNow(robot);
  if (OffCentre(geometry, pose.position, path.front()) < kBackInTheMiddle) robot.to_centre = false;
  const bool park = path.size() == 1;  // at the end of a task
  const DriveAction meant =
      ChooseKey(parameters_.steering, geometry, pose, path, robot.to_centre || park);
  if (!tasks_.empty() && tasks_.front().robot == name) --tasks_.front().keys_left;
  return Order(name, robot, Press(robot, meant), now);
}

void SyntheticTeleoperator::Answered(const Result<OperatorReply>& reply, Clock::TimePoint now) {
  DEMAND(under_way_);
  const OperatorAsk ask = *std::exchange(under_way_, std::nullopt);
  const bool accepted = reply && reply->accepted;
  if (!accepted) {
    ++counts_.refused;
    counts_.newest_problem = reply ? reply->reason : reply.error().text;
    not_before_ = now + Seconds(parameters_.retry_pause_s);
  }
  if (const auto* edit = std::get_if<EditRequest>(&ask.body)) {
    World& world = worlds_.at(ask.world);
    if (reply) world.revision_needed = std::max(world.revision_needed, reply->revision);
    if (accepted) counts_.edits += edit->edits.size();
    return;
  }
  if (!accepted) {
    refused_ = ask;
    return;
  }
  Robot& robot = robots_.at(std::get<DriveRequest>(ask.body).robot);
  robot.order = reply->revision;
  ++counts_.keys;
}

}  // namespace conav::operators
