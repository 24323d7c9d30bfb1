#include "common/bus/deduplicator.h"

#include <algorithm>

namespace conav::bus {

bool Deduplicator::IsNew(const Guid& writer, std::int64_t stamp) {
  Window& window = WindowOf(writer);
  if (std::find(window.stamps.begin(), window.stamps.end(), stamp) != window.stamps.end()) {
    return false;
  }
  if (window.stamps.size() < kWindow) {
    window.stamps.push_back(stamp);
  } else {
    window.stamps[window.oldest] = stamp;
    window.oldest = (window.oldest + 1) % kWindow;
  }
  return true;
}

Deduplicator::Window& Deduplicator::WindowOf(const Guid& writer) {
  const auto of_writer = [&](const Window& window) { return window.writer == writer; };
  const auto found = std::find_if(windows_.rbegin(), windows_.rend(), of_writer);
  if (found != windows_.rend()) {
    std::rotate(found.base() - 1, found.base(), windows_.end());
    return windows_.back();
  }
  if (windows_.size() >= kWriters) windows_.erase(windows_.begin());
  windows_.push_back({writer, {}, 0});
  return windows_.back();
}

}  // namespace conav::bus
