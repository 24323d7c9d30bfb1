#pragma once

#include <cstdint>

#include "planner/method.h"

namespace conav::planner {

/// Teleoperation, cell by cell: each guidance is one order, whose first step is passed on; then the
/// robot asks for the next one. Nothing is decided here but whether the step can be made. Pictures
/// are streamed.
class TeleopMethod final : public Method {
 public:
  Decision Decide(const Situation& situation) override;
  bool pictures_are_answered() const override { return false; }

 private:
  std::uint64_t done_revision_ = 0;  // of the guidance whose step was passed on
};

}  // namespace conav::planner
