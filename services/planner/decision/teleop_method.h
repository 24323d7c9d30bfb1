#pragma once

#include <cstdint>

#include "planner/decision/follow_path.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// Teleoperation, cell by cell: each guidance is one order, whose first step is passed on; then the
/// robot asks for the next one. What is decided here is whether the step can be made; where robots
/// meet, the right of way (traffic.h) moves this one, too. Pictures are streamed.
class TeleopMethod final : public Method {
 public:
  TeleopMethod(std::uint64_t seed, const Clock& clock) : follower_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  bool pictures_are_answered() const override { return false; }

 private:
  bool IsDone(const Guidance& order) const;

  // Of the guidance whose step was passed on; a goal pose keeps the revision, not the stamp.
  std::uint64_t done_revision_ = 0;
  SimTime done_stamp_;
  PathFollower follower_;
};

}  // namespace conav::planner
