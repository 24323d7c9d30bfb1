#pragma once

#include <cstdint>
#include <optional>

#include "common/mapping/mapping_tour.h"
#include "planner/decision/method.h"
#include "planner/decision/stand_off.h"

namespace conav::planner {

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
  bool HasErrand(const Situation& situation);

  std::uint64_t seed_;
  StandOff stand_off_;
  std::optional<MappingTour> tour_;  // from the first decision on
  std::optional<Errand> errand_;
};

}  // namespace conav::planner
