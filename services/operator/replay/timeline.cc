#include "operator/replay/timeline.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "common/grid/map_accuracy.h"
#include "operator/console/console_messages.h"
#include "operator/supervision/command_log.h"

namespace conav::operators {
namespace {

constexpr double kSilentAfterS = std::chrono::duration<double>(kSilentAfter).count();

/// An answer "nothing new here" leaves path and time as they are, and names a newer picture.
bool IsAnswer(const std::optional<Guidance>& before, const Guidance& now) {
  if (!before) return now.path.empty() && now.answers_snapshot > 0;
  const bool same =
      now.path == before->path && (now.path.empty() || now.valid_until == before->valid_until);
  return same && now.answers_snapshot > before->answers_snapshot;
}

}  // namespace

TimelineBuilder::TimelineBuilder(console::Session session) {
  timeline_.session = std::move(session);
}

void TimelineBuilder::MoveTo(double wall_s) {
  if (!first_wall_s_) first_wall_s_ = wall_s;
  Follow(wall_s);
}

void TimelineBuilder::Follow(double wall_s) {
  if (first_wall_s_) position_s_ = std::max(position_s_, wall_s - *first_wall_s_);
}

void TimelineBuilder::MoveWith(const RobotState& state) {
  WorldMemory& world = worlds_[state.world];
  const RobotMemory& robot = robots_[state.robot];
  const bool is_new_run = robot.reported && state.stamp < robot.stamp;
  if (!world.stamp || is_new_run) {
    world.stamp = state.stamp;
    world.position_s = position_s_;
    world.newest = state.stamp;
  }
  world.newest = std::max(world.newest, state.stamp);
  const double since_s = state.stamp.ToSeconds() - world.stamp->ToSeconds();
  position_s_ = std::max(position_s_, world.position_s + since_s);
}

std::size_t TimelineBuilder::Add(Received value) {
  timeline_.moments.push_back({position_s_, Moment::kNever, std::move(value)});
  return timeline_.moments.size() - 1;
}

void TimelineBuilder::Add(const std::string& group, bool replaceable, Received value) {
  const std::size_t moment = Add(std::move(value));
  Replaceable& last = groups_[group];
  if (last.is) timeline_.moments[last.moment].replaced_by = moment;
  last = {moment, replaceable};
}

void TimelineBuilder::Mark(console::MarkKind kind, const std::string& robot, std::string text) {
  console::Mark mark;
  mark.set_kind(kind);
  mark.set_position(position_s_);
  mark.set_robot(robot);
  mark.set_text(std::move(text));
  timeline_.marks.push_back(std::move(mark));
}

void TimelineBuilder::Receive(double wall_s, RobotState state) {
  MoveTo(wall_s);
  MoveWith(state);
  RobotMemory& robot = robots_[state.robot];
  // The trail needs the states in which it enters a cell.
  const bool moved =
      !robot.reported || state.stamp < robot.stamp || state.cell_moves != robot.cell_moves;
  if (robot.reported && state.goals_reached.size() > robot.goals_reached) {
    Mark(console::MARK_GOAL, state.robot,
         fmt::format("{} reached goal {} of {}", state.robot, state.goals_reached.size(),
                     state.goals_total));
  }
  robot.reported = true;
  robot.lost = false;
  robot.world = state.world;
  robot.stamp = state.stamp;
  robot.cell_moves = state.cell_moves;
  robot.goals_reached = state.goals_reached.size();
  const std::string group = "state/" + state.robot;
  Add(group, !moved, std::move(state));
}

void TimelineBuilder::ReceiveSeen(double wall_s, const std::string& robot, MapUpdate map) {
  MoveTo(wall_s);
  Add("seen/" + robot, true, SeenMap{robot, robots_[robot].world, std::move(map)});
}

void TimelineBuilder::ReceiveInitialMap(double wall_s, const std::string& world, MapUpdate map) {
  MoveTo(wall_s);
  WorldMemory& memory = worlds_[world];
  memory.geometry = map.geometry();
  memory.initial = std::make_shared<const BeliefGrid>(ToBelief(map.cells));
  Add(InitialMap{world, std::move(map)});
}

void TimelineBuilder::ReceiveTruth(double wall_s, const std::string& world, MapUpdate truth) {
  MoveTo(wall_s);
  Add(TrueMap{world, std::move(truth)});
}

void TimelineBuilder::Receive(double wall_s, Belief belief) {
  MoveTo(wall_s);
  WorldMemory& world = worlds_[belief.world];
  if (!world.initial) world.initial = std::make_shared<const BeliefGrid>(belief.wall_probability);
  if (world.belief && belief.revision > world.belief->revision) {
    Mark(console::MARK_EDIT, "",
         fmt::format("{}: revision {} by {}", belief.world, belief.revision, belief.edited_by));
  }
  world.belief = belief;
  const std::string group = "belief/" + belief.world;
  Add(group, true, ReceivedBelief{std::move(belief), world.initial});
}

void TimelineBuilder::Receive(double wall_s, Guidance guidance) {
  MoveTo(wall_s);
  std::optional<Guidance>& before = robots_[guidance.robot].guidance;
  const bool is_stored = !before && guidance.revision > 1;  // before the recording began
  const bool is_new = !is_stored && (!before || guidance.revision > before->revision);
  if (is_new && IsAnswer(before, guidance)) {
    Add(SnapshotAnswered{guidance.robot, guidance.answers_snapshot, guidance.given_by});
    Mark(console::MARK_GUIDANCE, guidance.robot,
         fmt::format("{}: nothing new in picture {}", guidance.robot, guidance.answers_snapshot));
  } else if (is_new) {
    Mark(console::MARK_GUIDANCE, guidance.robot,
         fmt::format("{}: {} {}", guidance.robot, guidance.given_by,
                     PathText(guidance.path.size())));
  }
  before = guidance;
  Add(std::move(guidance));
}

void TimelineBuilder::ReceivePlan(double wall_s, const std::string& robot, SimTime stamp,
                                  const std::vector<Position>& positions) {
  MoveTo(wall_s);
  const auto& geometry = worlds_[robots_[robot].world].geometry;
  if (geometry) {
    Add("plan/" + robot, true, PlannedPath{robot, stamp, CellsAt(positions, *geometry)});
  }
}

void TimelineBuilder::ReceiveGoalPose(double wall_s, const std::string& robot, Position goal) {
  MoveTo(wall_s);
  const WorldMemory& world = worlds_[robots_[robot].world];
  const auto cell = world.geometry ? CellAt(goal, *world.geometry) : std::nullopt;
  if (cell) Add("goal_pose/" + robot, true, GoalSet{robot, *cell, world.newest});
}

void TimelineBuilder::Receive(double wall_s, SearchReport report) {
  MoveTo(wall_s);
  report.tree.clear();  // not shown
  report.views.clear();
  const std::string group = "search/" + report.robot;
  Add(group, true, std::move(report));
}

void TimelineBuilder::Receive(double wall_s, Snapshot snapshot) {
  MoveTo(wall_s);
  if (snapshot.streamed) return;
  Mark(console::MARK_SNAPSHOT, snapshot.robot,
       fmt::format("picture {} of {}", snapshot.sequence_number, snapshot.robot));
  Add(std::move(snapshot));
}

void TimelineBuilder::ReceiveFrame(double wall_s, StreamFrame frame) {
  MoveTo(wall_s);
  const std::string group = "frame/" + frame.robot;
  Add(group, true, std::move(frame));
}

void TimelineBuilder::Receive(double wall_s, AttentionQueueState queue) {
  Follow(wall_s);
  items_ = queue.items;
  // The notice leaves the queue after a while; the robot is lost until it reports again.
  for (const AttentionItem& item : items_) {
    if (item.reason == AttentionReason::kLinkLost) robots_[item.robot].lost = true;
  }
  Add("attention", true, std::move(queue));
  UpdateAlerts(wall_s);
}

void TimelineBuilder::Receive(double wall_s, StopOrder order) {
  MoveTo(wall_s);
  Add(std::move(order));
}

void TimelineBuilder::Receive(double wall_s, ServiceHealth health) {
  Follow(wall_s);
  processes_[health.name] = {health, wall_s};
  const std::string group = "health/" + health.name;
  Add(group, true, std::move(health));
  UpdateAlerts(wall_s);
}

void TimelineBuilder::CheckSilence(double wall_s) {
  for (auto& [name, process] : processes_) {
    if (wall_s - process.wall_s <= kSilentAfterS) continue;
    if (process.health.level == console::LEVEL_SILENT) continue;
    process.health.level = console::LEVEL_SILENT;
    process.health.message = "silent";
    Add("health/" + name, true, process.health);
  }
}

std::vector<RobotCondition> TimelineBuilder::RobotConditions() const {
  std::vector<RobotCondition> conditions;
  for (const auto& [name, robot] : robots_) {
    if (!robot.reported && !robot.lost) continue;
    conditions.push_back({name, robot.lost, Stands(items_, name)});
  }
  return conditions;
}

void TimelineBuilder::UpdateAlerts(double wall_s) {
  CheckSilence(wall_s);
  std::vector<ProcessCondition> processes;
  for (const auto& [name, process] : processes_) {
    const console::Level level = process.health.level;
    processes.push_back({name, level == console::LEVEL_ERROR, level == console::LEVEL_SILENT,
                         process.health.message});
  }
  const Findings findings = FindingsOf(RobotConditions(), processes, std::nullopt);
  for (const Alert& alert : alerts_.Update(findings, position_s_).changed) {
    std::uint32_t& shown = alert_counts_[alert.id];
    if (alert.active && alert.count > std::exchange(shown, alert.count)) {
      Mark(console::MARK_ALERT, alert.condition.source, alert.condition.text);
    }
    Add(alert);
  }
}

void TimelineBuilder::Receive(double wall_s, const OperatorEvent& event) {
  Follow(wall_s);
  if (event.kind == RequestKind::kNote && event.accepted) {
    Mark(console::MARK_NOTE, event.robot, event.text);
  }
  Add(ToConsole(event, wall_s));
}

Timeline TimelineBuilder::Finish() && {
  timeline_.began_s = first_wall_s_.value_or(0.0);
  timeline_.duration_s = position_s_;
  return std::move(timeline_);
}

}  // namespace conav::operators
