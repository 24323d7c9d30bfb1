#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/grid/mapping_tour.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "planner/decision/method.h"
#include "planner/decision/traffic.h"
#include "planner/methods/region_navigation.h"

// One user: make_method; the baselines are looked for by name.

namespace conav::planner {

/// Handles another robot on the next cell: waits for kPatience, then steps aside at random, so that
/// two robots do not wait for each other for ever.
class StandOff {
 public:
  /// `clock` outlives this.
  StandOff(std::uint64_t seed, const Clock& clock) : random_(seed), patience_(clock) {}

  /// The next cell of `path` is taken, or there is no path: wait (no action), or the random step.
  Decision WaitOrStepOut(const Situation& situation, const std::vector<Cell>& path);
  /// The next cell is free, or another one.
  void End() { patience_.End(); }

 private:
  Random random_;
  Patience patience_;
};

/// Follows a guidance path cell by cell and remembers its position on it, because a tour may visit a
/// cell several times. A new path starts at its beginning, and so does the same path given again.
class PathFollower {
 public:
  /// As StandOff.
  PathFollower(std::uint64_t seed, const Clock& clock) : stand_off_(seed, clock) {}

  /// The move to the cell after the robot's own on the path, or the obstacle: kBlocked with the
  /// wall's cell, kNoGuidance when there is no path, none is left, or the robot is off it. Waits,
  /// without asking, while another robot stands on that cell; after kPatience it steps aside at
  /// random.
  Decision Next(const Situation& situation);
  /// The rest of the path after the robot's cell; empty when it has no path, is off it, or has no
  /// goals left.
  std::vector<Cell> Rest(const Situation& situation);

 private:
  /// Takes over a new path and finds the robot on it; false when it is not there.
  bool Locate(const Situation& situation);
  Decision FollowOrAsk(const Situation& situation);

  StandOff stand_off_;  // with another robot on the path
  std::vector<Cell> path_;
  std::uint64_t revision_ = 0;  // of the guidance that path_ was; likewise:
  SimTime stamp_;
  std::size_t position_ = 0;  // of the robot in path_
};

/// Instruction following (paper section 6.2): the robot follows the operator's path cell by cell.
/// When the next cell is a wall, or the path ends, it pauses and asks for new guidance. It streams
/// pictures.
class InstructionMethod final : public Method {
 public:
  InstructionMethod(std::uint64_t seed, const Clock& clock) : follower_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> IntendedPathFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kGuidance; }

 private:
  PathFollower follower_;
};

/// Teleoperation: passes each low-level action of the operator on once, under this planner's lease
/// and with the order's own expiry; drops an order that came too late. It decides nothing: without
/// orders the robot stands, and where robots meet the operator makes room. Of several orders that
/// arrive during an action the newest counts. It ignores guidance and streams pictures. Source:
/// paper section 6.2.
class TeleopMethod final : public Method {
 public:
  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> IntendedPathFor(const Situation&) override { return {}; }
  AwaitedInput awaits() const override { return AwaitedInput::kBelief; }
  bool is_steered() const override { return true; }

 private:
  std::uint64_t newest_order_ = 0;  // passed on, or too late
};

/// The greedy robot: always takes the shortest path to its nearest goal on its own map, where an
/// unseen cell counts as free, at the cost of one step like any other (breadth-first search, as the
/// greedy robot of the paper's waterway example, section 6.3); with `regions` on their graph, from
/// vertex to vertex. It sends no pictures and ignores the operator. Like robots of the other methods it waits while another robot stands on its next cell.
/// If it cannot reach any goal it stays.
class GreedyMethod final : public Method {
 public:
  GreedyMethod(std::uint64_t seed, const Clock& clock,
               const std::optional<RegionOptions>& regions = std::nullopt);

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  void Prepare(const OccupancyGrid& map) override;
  std::vector<Cell> IntendedPathFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kNothing; }

 private:
  Decision DecideOnRegions(const Situation& situation);

  StandOff stand_off_;
  std::shared_ptr<const GridViews> no_views_;
  std::optional<RegionNavigation> regions_;  // none: from cell to cell
};

/// The robot of the mapping task (paper, Appendix A). It knows the true maze and the person's map,
/// drives the shortest path from stop to stop of a MappingTour, and sends one picture at each. Then
/// it stands until the person has answered that picture, without a timeout; edits alone do not make
/// it go on.
///
/// Waits for the true map, for the map on which the answer was given, and while another robot stands
/// on its next cell. A planner that takes over begins its own tour, by the goals that are left.
class MappingMethod final : public Method {
 public:
  MappingMethod(std::uint64_t seed, const Clock& clock) : seed_(seed), stand_off_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> IntendedPathFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kBelief; }

 private:
  struct SnapshotTask {
    MappingStop stop;
    std::uint64_t snapshots_before = 0;  // it is done when the robot has sent more
  };

  /// Draws the next stop, unless the robot is on its way to one; false where it has to wait.
  bool HasTask(const Situation& situation);

  std::uint64_t seed_;
  StandOff stand_off_;
  std::optional<MappingTour> tour_;  // from the first decision on
  std::optional<SnapshotTask> task_;
};

}  // namespace conav::planner
