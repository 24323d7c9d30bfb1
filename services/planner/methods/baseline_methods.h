#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/grid/mapping_tour.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// What a robot does while another one stands in its way: waits for kPatience, then steps out of
/// the way at random, so that two that wait for each other do not do so for ever.
class StandOff {
 public:
  /// `clock` outlives this.
  StandOff(std::uint64_t seed, const Clock& clock) : random_(seed), clock_(clock) {}

  /// The way is taken: wait (no action), or the random step.
  Decision WaitOrStepOut(const Situation& situation);
  /// The way is free, or another one.
  void End() { since_.reset(); }

 private:
  Random random_;
  const Clock& clock_;
  std::optional<Clock::TimePoint> since_;
};

/// Goes along a guidance path cell by cell and remembers how far it has come, because a tour may
/// lead through one cell several times. A new path starts at its beginning, and so does the same
/// one given again.
class PathFollower {
 public:
  /// As StandOff.
  PathFollower(std::uint64_t seed, const Clock& clock) : stand_off_(seed, clock) {}

  /// The move to the cell that follows the robot's own on the path, or what stands in the way:
  /// kBlocked with the wall's cell, kNoGuidance when there is no path, nothing left of it, or the
  /// robot is beside it. Waits, without asking, while another robot stands on that cell; after half
  /// a second of that it steps out of the path at random.
  Decision Next(const Situation& situation);
  /// What is left of the path after the robot's cell; empty when it has no path, is beside it, or
  /// has no goals left.
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

/// Instruction following (paper section 6.2): the robot goes along the operator's path cell by
/// cell. When the next cell is a wall, or the path is used up, it pauses and asks for new guidance.
/// Pictures are streamed.
class InstructionMethod final : public Method {
 public:
  InstructionMethod(std::uint64_t seed, const Clock& clock) : follower_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kGuidance; }

 private:
  PathFollower follower_;
};

/// Teleoperation: each low-level action of whoever steers the robot is passed on once, under this
/// planner's lease and with the order's own expiry; an order that came too late is left out.
/// Nothing is decided here: without orders the robot stands, and where robots meet it is the
/// operator's to make room. Of several orders that arrive while an action is carried out, the
/// newest counts. Guidance is not followed. Pictures are streamed. Source: paper section 6.2.
class TeleopMethod final : public Method {
 public:
  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation&) override { return {}; }
  AwaitedInput awaits() const override { return AwaitedInput::kBelief; }
  bool is_steered() const override { return true; }

 private:
  std::uint64_t newest_order_ = 0;  // passed on, or too late
};

/// The greedy robot: always along the shortest way to its nearest goal on its own map, where a cell
/// that it has not seen counts as free, at the cost of one step like any other (breadth-first
/// search, as the greedy robot of the paper's waterway example, section 6.3). It sends no pictures
/// and heeds no operator. Waits, as do robots of the other methods, while another one stands in its
/// way. Where no goal can be reached it stays.
class GreedyMethod final : public Method {
 public:
  GreedyMethod(std::uint64_t seed, const Clock& clock) : stand_off_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kNothing; }

 private:
  StandOff stand_off_;
};

/// The robot of the mapping task (paper, Appendix A). It knows the true maze as well as the
/// person's map, drives the shortest way from stop to stop of a MappingTour, and sends one picture
/// at each. Then it stands until that picture was answered, however long it takes; edits alone do
/// not make it go on.
///
/// Waits while the true map is not known, the map on which the answer was given has not come, or
/// another robot stands in its way. A planner that takes over begins a tour of its own, by the
/// goals that are left.
class MappingMethod final : public Method {
 public:
  MappingMethod(std::uint64_t seed, const Clock& clock) : seed_(seed), stand_off_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kBelief; }

 private:
  struct Errand {
    MappingStop stop;
    std::uint64_t snapshots_before = 0;  // it is done when the robot has sent more
  };

  /// Draws the next stop, unless the robot is on its way to one; false where it has to wait.
  bool HasTask(const Situation& situation);

  std::uint64_t seed_;
  StandOff stand_off_;
  std::optional<MappingTour> tour_;  // from the first decision on
  std::optional<Errand> errand_;
};

}  // namespace conav::planner
