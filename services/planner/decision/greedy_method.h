#pragma once

#include <cstdint>

#include "planner/decision/method.h"
#include "planner/decision/stand_off.h"

namespace conav::planner {

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

}  // namespace conav::planner
