#include "operator/recording/segment_collector.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
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

}  // namespace

SegmentCollector::SegmentCollector(SessionFacts session, std::map<std::string, MazeFacts> mazes)
    : session_(std::move(session)), mazes_(std::move(mazes)) {}

void SegmentCollector::Begin(const Belief& belief, Clock::TimePoint now) {
  const auto known = worlds_.find(belief.world);
  if (known != worlds_.end()) {
    DEMAND(SameShape(known->second.initial, belief.wall_probability), belief.world);
    return;
  }
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
  worlds_.emplace(belief.world, std::move(world));
}

void SegmentCollector::SetTruth(const std::string& world, const OccupancyGrid& truth) {
  truths_.insert_or_assign(world, truth);
}

void SegmentCollector::Skip(const std::string& robot, std::uint64_t answered) {
  robots_[robot].newest = answered;
}

void SegmentCollector::Receive(const RobotState& state) {
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

void SegmentCollector::Receive(Snapshot snapshot, Clock::TimePoint now) {
  Robot& robot = robots_[snapshot.robot];
  const auto found = worlds_.find(snapshot.world);
  if (found == worlds_.end() || snapshot.streamed || snapshot.sequence_number <= robot.newest)
    return;
  World& world = found->second;
  robot.world = snapshot.world;
  robot.newest = snapshot.sequence_number;
  if (robot.open) {
    Close(world, snapshot.robot, TakeFrom(robot.open), world.belief, {});
    Settle(snapshot.world);
  }
  const auto left = static_cast<std::uint32_t>(snapshot.goals_left.size());
  const std::string name = snapshot.robot;
  OpenSegment open{std::move(snapshot),
                   world.belief,
                   {},
                   now,
                   robot.goals_total > left ? robot.goals_total - left : 0};
  if (robot.early && robot.early->sequence_number == robot.newest) {
    const EarlyAnswer early = TakeFrom(robot.early);
    open.belief = early.before;
    open.first_edit = early.first_edit;
    Close(world, name, std::move(open), early.after, early.confirmed);
    return;
  }
  const bool edited_just_before = world.first_edit && now - *world.first_edit <= kGrace;
  if (edited_just_before) {
    open.belief = world.settled;
    open.first_edit = world.first_edit;
  }
  robot.open = std::move(open);
}

void SegmentCollector::Edited(const Belief& belief, Clock::TimePoint now) {
  const auto found = worlds_.find(belief.world);
  if (found == worlds_.end()) return;
  World& world = found->second;
  DEMAND(SameShape(world.initial, belief.wall_probability), belief.world);
  world.belief = Binarised(belief.wall_probability);
  if (!world.first_edit) world.first_edit = now;
  for (OpenSegment* open : OpenIn(belief.world)) {
    if (!open->first_edit) open->first_edit = now;
  }
}

void SegmentCollector::Guided(const Guidance& guidance, Clock::TimePoint now) {
  const auto found = worlds_.find(guidance.world);
  if (found == worlds_.end()) return;
  World& world = found->second;
  Robot& robot = robots_[guidance.robot];
  const std::uint64_t answered = guidance.answers_snapshot;
  if (robot.open && robot.open->snapshot.sequence_number == answered) {
    Close(world, guidance.robot, TakeFrom(robot.open), world.belief, now);
  } else if (robot.early && robot.early->sequence_number == answered) {
    return;  // another path after the answer
  } else if (answered > robot.newest) {
    robot.early = EarlyAnswer{answered, world.settled, world.belief, world.first_edit, now};
  } else {
    return ForgetGrace(world);
  }
  Settle(guidance.world);
}

void SegmentCollector::Finish(Clock::TimePoint now) {
  for (auto& [name, robot] : robots_) {
    const auto world = worlds_.find(robot.world);
    if (!robot.open || world == worlds_.end()) continue;
    Close(world->second, name, TakeFrom(robot.open), world->second.belief, now);
    Settle(robot.world);
  }
}

void SegmentCollector::End() {
  for (auto& [name, robot] : robots_) {
    const auto world = worlds_.find(robot.world);
    if (!robot.open || world == worlds_.end()) continue;
    const OpenSegment open = TakeFrom(robot.open);
    if (open.belief == world->second.belief) continue;
    Close(world->second, name, open, world->second.belief, {});
    Settle(robot.world);
  }
}

void SegmentCollector::ForgetGrace(World& world) {
  world.settled = world.belief;
  world.first_edit.reset();
}

void SegmentCollector::Settle(const std::string& name) {
  World& world = worlds_.at(name);
  ForgetGrace(world);
  for (OpenSegment* open : OpenIn(name)) {
    open->belief = world.belief;
    open->first_edit.reset();
  }
}

std::vector<SegmentCollector::OpenSegment*> SegmentCollector::OpenIn(const std::string& world) {
  std::vector<OpenSegment*> open;
  for (auto& [name, robot] : robots_) {
    if (robot.open && robot.world == world) open.push_back(&*robot.open);
  }
  return open;
}

void SegmentCollector::Close(World& world, const std::string& robot, OpenSegment open,
                             const BeliefGrid& after, std::optional<Clock::TimePoint> confirmed) {
  const auto seconds = [&](Clock::TimePoint time) {
    return std::chrono::duration<double>(std::max(time, open.sent) - world.began).count();
  };
  RecordedSegment done;
  Segment& segment = done.segment;
  segment.step = world.next_step++;
  segment.query = {std::move(open.belief), std::move(open.snapshot.path), open.snapshot.cell,
                   open.snapshot.heading_rad, std::move(open.snapshot.visible)};
  segment.belief_after = after;
  segment.sent_s = seconds(open.sent);
  if (open.first_edit && EditCount(segment) > 0) segment.first_edit_s = seconds(*open.first_edit);
  if (confirmed) segment.confirmed_s = seconds(*confirmed);
  segment.goals_reached = open.goals_reached;
  done.world = open.snapshot.world;
  const auto truth = truths_.find(done.world);
  if (truth != truths_.end() && SameShape(truth->second, after)) {
    world.facts.truth = truth->second;
    Measure(world.facts, world.initial, after);
  }
  done.trajectory = world.facts;
  done.robot = robot;
  done.sequence_number = open.snapshot.sequence_number;
  done.jpeg = std::move(open.snapshot.jpeg);
  completed_.push_back(std::move(done));
}

void SegmentCollector::Measure(Trajectory& trajectory, const BeliefGrid& initial,
                               const BeliefGrid& final) {
  const OccupancyGrid before = ToOccupancy(initial);
  trajectory.initial_cell_accuracy = CompareMaps(*trajectory.truth, before, initial).cell;
  const MapAccuracy now = CompareMaps(*trajectory.truth, before, final);
  trajectory.final_cell_accuracy = now.cell;
  trajectory.final_mapping_accuracy = now.mapping;
}

std::vector<RecordedSegment> SegmentCollector::Take() { return std::exchange(completed_, {}); }

Result<std::map<std::string, MazeFacts>> ParseMazeFacts(const std::vector<std::string>& entries) {
  std::map<std::string, MazeFacts> facts;
  for (const std::string& entry : entries) {
    const auto equals = entry.find('=');
    const auto at = entry.rfind('@');
    const bool has_seed = at != std::string::npos && equals != std::string::npos && at > equals;
    MazeFacts maze;
    bool good = equals != std::string::npos && equals > 0;
    if (has_seed) {
      const char* end = entry.data() + entry.size();
      const auto parsed = std::from_chars(entry.data() + at + 1, end, maze.world_seed);
      good = good && parsed.ec == std::errc() && parsed.ptr == end;
    }
    if (!good) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("'{}' is not WORLD=PRESET@SEED or WORLD=FILE", entry));
    }
    maze.corruption_seed = maze.world_seed;
    maze.name = entry.substr(equals + 1, has_seed ? at - equals - 1 : std::string::npos);
    facts.insert_or_assign(entry.substr(0, equals), maze);
  }
  return facts;
}

}  // namespace conav::operators
