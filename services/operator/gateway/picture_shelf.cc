#include "operator/gateway/picture_shelf.h"

#include <algorithm>

namespace conav::operators {

void PictureShelf::Put(const std::string& robot, std::uint64_t number,
                       std::vector<std::uint8_t> jpeg) {
  const Key key{robot, number};
  const std::lock_guard lock(mutex_);
  EraseLocked(key);
  if (jpeg.empty() || jpeg.size() > limit_) return;
  while (bytes_ + jpeg.size() > limit_) {
    const Key oldest = order_.front();
    EraseLocked(oldest);
  }
  bytes_ += jpeg.size();
  pixels_[key] = std::make_shared<const std::string>(jpeg.begin(), jpeg.end());
  order_.push_back(key);
}

PictureShelf::Pixels PictureShelf::Find(const std::string& robot, std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = pixels_.find({robot, number});
  return found == pixels_.end() ? nullptr : found->second;
}

void PictureShelf::EraseLocked(const Key& key) {
  const auto found = pixels_.find(key);
  if (found == pixels_.end()) return;
  bytes_ -= found->second->size();
  pixels_.erase(found);
  order_.erase(std::find(order_.begin(), order_.end(), key));
}

}  // namespace conav::operators
