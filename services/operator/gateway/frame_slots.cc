#include "operator/gateway/frame_slots.h"

#include <utility>

namespace conav::operators {

void FrameSlots::Put(console::Frame frame) {
  const std::lock_guard lock(mutex_);
  Slot& slot = slots_[frame.robot()];
  frame.set_number(++slot.number);
  slot.frame = std::make_shared<const console::Frame>(std::move(frame));
}

std::map<std::string, FrameSlots::Slot> FrameSlots::Newer(
    const std::map<std::string, std::uint64_t>& seen) const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, Slot> newer;
  for (const auto& [robot, slot] : slots_) {
    const auto known = seen.find(robot);
    if (known == seen.end() || known->second < slot.number) newer.emplace(robot, slot);
  }
  return newer;
}

std::map<std::string, std::uint64_t> FrameSlots::Numbers() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::uint64_t> numbers;
  for (const auto& [robot, slot] : slots_) numbers[robot] = slot.number;
  return numbers;
}

}  // namespace conav::operators
