#include "operator/gateway/snapshot_store.h"

#include <algorithm>

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

void SnapshotStore::Put(const std::string& robot, std::uint64_t number,
                        std::vector<std::uint8_t>&& jpeg) {
  const Key key{robot, number};
  const std::lock_guard lock(mutex_);
  EraseLocked(key);
  if (jpeg.empty() || jpeg.size() > limit_) return;
  while (bytes_ + jpeg.size() > limit_) {
    const Key oldest = order_.front();
    EraseLocked(oldest);
  }
  bytes_ += jpeg.size();
  pixels_[key] = std::make_shared<const std::vector<std::uint8_t>>(std::move(jpeg));
  order_.push_back(key);
}

SnapshotStore::Pixels SnapshotStore::Find(const std::string& robot, std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = pixels_.find({robot, number});
  return found == pixels_.end() ? nullptr : found->second;
}

void SnapshotStore::EraseLocked(const Key& key) {
  const auto found = pixels_.find(key);
  if (found == pixels_.end()) return;
  bytes_ -= found->second->size();
  pixels_.erase(found);
  order_.erase(std::find(order_.begin(), order_.end(), key));
}

}  // namespace conav::operators
