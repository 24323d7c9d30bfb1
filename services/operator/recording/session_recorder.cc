#include "operator/recording/session_recorder.h"

#include <algorithm>
#include <utility>

#include "common/grid/map_accuracy.h"

namespace conav::operators {
namespace {

BeliefGrid Binarised(const BeliefGrid& belief) {
  BeliefGrid map(belief.rows(), belief.columns());
  std::ranges::transform(belief.values(), map.values().begin(), [](float probability) {
    return probability >= kWallThreshold ? 1.0F : 0.0F;
  });
  return map;
}

template <class A, class B>
bool SameShape(const Grid<A>& a, const Grid<B>& b) {
  return a.rows() == b.rows() && a.columns() == b.columns();
}

template <class T>
T TakeFrom(std::optional<T>& held) {
  T value = std::move(*held);
  held.reset();
  return value;
}

OccupancyGrid AsMap(const BeliefGrid& belief) {
  OccupancyGrid map(belief.rows(), belief.columns());
  std::ranges::transform(belief.values(), map.values().begin(), [](float wall) {
    return wall != 0.0F ? Occupancy::kOccupied : Occupancy::kFree;
  });
  return map;
}

}  // namespace

SessionRecorder::SessionRecorder(SessionFacts session, std::map<std::string, MazeFacts> mazes)
    : session_(std::move(session)), mazes_(std::move(mazes)) {}

void SessionRecorder::Begin(const Belief& belief, Clock::TimePoint now) {
  const auto known = worlds_.find(belief.world);
  if (known != worlds_.end() && SameShape(known->second.initial, belief.wall_probability)) return;
  World world;
  world.facts.origin = session_.origin;
  world.facts.participant = session_.participant;
  world.facts.session = session_.session;
  const auto maze = mazes_.find(belief.world);
  if (maze != mazes_.end()) {
    world.facts.world = maze->second.name;
    world.facts.world_seed = maze->second.world_seed;
    world.facts.corruption_seed = maze->second.corruption_seed;
  }
  world.initial = world.belief = world.settled = Binarised(belief.wall_probability);
  world.began = now;
  worlds_.insert_or_assign(belief.world, std::move(world));
}

void SessionRecorder::SetTruth(const std::string& world, const OccupancyGrid& truth) {
  truths_.insert_or_assign(world, truth);
}

void SessionRecorder::Skip(const std::string& robot, std::uint64_t answered) {
  robots_[robot].newest = answered;
}

SessionRecorder::World* SessionRecorder::Find(const std::string& world, const BeliefGrid& map) {
  const auto found = worlds_.find(world);
  return found != worlds_.end() && SameShape(found->second.initial, map) ? &found->second : nullptr;
}

void SessionRecorder::Hear(const RobotState& state) {
  Robot& robot = robots_[state.robot];
  const bool restarted = robot.stamp && state.stamp < *robot.stamp;
  if (restarted) {
    robot.newest = 0;
    robot.open.reset();
    robot.early.reset();
  }
  robot.world = state.world;
  robot.stamp = state.stamp;
  robot.goals_total = state.goals_total;
}

void SessionRecorder::Hear(Picture picture, Clock::TimePoint now) {
  Robot& robot = robots_[picture.robot];
  const auto found = worlds_.find(picture.world);
  if (found == worlds_.end() || picture.streamed || picture.sequence_number <= robot.newest) return;
  World& world = found->second;
  robot.world = picture.world;
  robot.newest = picture.sequence_number;
  if (robot.open) {
    Close(world, picture.robot, TakeFrom(robot.open), world.belief, world.first_edit, {});
    Settle(picture.world);
  }
  const auto left = static_cast<std::uint32_t>(picture.goals_left.size());
  const std::string name = picture.robot;
  OpenSegment open{std::move(picture), world.belief, now,
                   robot.goals_total > left ? robot.goals_total - left : 0};
  if (robot.early && robot.early->sequence_number == robot.newest) {
    const EarlyAnswer early = TakeFrom(robot.early);
    open.belief = early.before;
    Close(world, name, std::move(open), early.after, early.first_edit, early.confirmed);
    return;
  }
  const bool edited_just_before = world.first_edit && now - *world.first_edit <= kGrace;
  if (edited_just_before) open.belief = world.settled;
  robot.open = std::move(open);
}

void SessionRecorder::Edited(const Belief& belief, Clock::TimePoint now) {
  World* world = Find(belief.world, belief.wall_probability);
  if (world == nullptr) return;
  world->belief = Binarised(belief.wall_probability);
  if (!world->first_edit) world->first_edit = now;
}

void SessionRecorder::Guided(const Guidance& guidance, Clock::TimePoint now) {
  const auto found = worlds_.find(guidance.world);
  if (found == worlds_.end()) return;
  World& world = found->second;
  Robot& robot = robots_[guidance.robot];
  const std::uint64_t answered = guidance.answers_snapshot;
  if (robot.open && robot.open->picture.sequence_number == answered) {
    Close(world, guidance.robot, TakeFrom(robot.open), world.belief, world.first_edit, now);
  } else if (answered > robot.newest) {
    robot.early = EarlyAnswer{answered, world.settled, world.belief, world.first_edit, now};
  }
  Settle(guidance.world);
}

void SessionRecorder::End() {
  for (auto& [name, robot] : robots_) {
    const auto world = worlds_.find(robot.world);
    if (!robot.open || world == worlds_.end()) continue;
    const OpenSegment open = TakeFrom(robot.open);
    if (open.belief == world->second.belief) continue;
    Close(world->second, name, open, world->second.belief, world->second.first_edit, {});
    Settle(robot.world);
  }
}

void SessionRecorder::Settle(const std::string& name) {
  World& world = worlds_.at(name);
  world.settled = world.belief;
  world.first_edit.reset();
  for (auto& [robot_name, robot] : robots_) {
    if (robot.open && robot.world == name) robot.open->belief = world.belief;
  }
}

void SessionRecorder::Close(World& world, const std::string& robot, OpenSegment open,
                            const BeliefGrid& after, std::optional<Clock::TimePoint> first_edit,
                            std::optional<Clock::TimePoint> confirmed) {
  if (!SameShape(open.belief, after)) return;
  const auto seconds = [&](Clock::TimePoint time) {
    return std::chrono::duration<double>(std::max(time, open.sent) - world.began).count();
  };
  RecordedSegment done;
  Segment& segment = done.segment;
  segment.step = world.next_step++;
  segment.query = {std::move(open.belief), std::move(open.picture.path), open.picture.cell,
                   open.picture.heading_rad, std::move(open.picture.visible)};
  segment.belief_after = after;
  segment.sent_s = seconds(open.sent);
  if (first_edit && EditCount(segment) > 0) segment.first_edit_s = seconds(*first_edit);
  if (confirmed) segment.confirmed_s = seconds(*confirmed);
  segment.goals_reached = open.goals_reached;
  done.world = open.picture.world;
  const auto truth = truths_.find(done.world);
  if (truth != truths_.end() && SameShape(truth->second, after)) {
    world.facts.truth = truth->second;
    Measure(world.facts, world.initial, after);
  }
  done.trajectory = world.facts;
  done.robot = robot;
  done.sequence_number = open.picture.sequence_number;
  done.jpeg = std::move(open.picture.jpeg);
  completed_.push_back(std::move(done));
}

void SessionRecorder::Measure(Trajectory& trajectory, const BeliefGrid& initial,
                              const BeliefGrid& final) {
  const OccupancyGrid before = AsMap(initial);
  trajectory.initial_cell_accuracy = CompareMaps(*trajectory.truth, before, initial).cell;
  const MapAccuracy now = CompareMaps(*trajectory.truth, before, final);
  trajectory.final_cell_accuracy = now.cell;
  trajectory.final_mapping_accuracy = now.mapping;
}

std::vector<RecordedSegment> SessionRecorder::Take() { return std::exchange(completed_, {}); }

}  // namespace conav::operators
