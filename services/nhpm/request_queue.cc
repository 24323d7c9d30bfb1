#include "nhpm/request_queue.h"

#include <algorithm>

namespace conav::nhpm {
namespace {

constexpr double kWeightOfNewest = 0.1;

bool IsSame(const PerceptionRequest& a, const PerceptionRequest& b) {
  return a.request_id == b.request_id && a.client == b.client;
}

}  // namespace

std::optional<Clock::TimePoint> OpenRequest::deadline() const {
  if (request.timeout_ms == 0) return std::nullopt;
  return arrived + std::chrono::milliseconds(request.timeout_ms);
}

std::size_t OpenRequest::cells() const {
  std::size_t sum = 0;
  for (const PerceptionQuery& query : request.queries) sum += query.belief.size();
  return sum;
}

RequestQueue::Admission RequestQueue::Offer(OpenRequest&& offered) {
  const PerceptionRequest& request = offered.request;
  const std::lock_guard lock(mutex_);
  for (OpenRequest& open : waiting_) {
    if (!IsSame(open.request, request)) continue;
    open.request.timeout_ms = request.timeout_ms;
    open.arrived = offered.arrived;
    return Admission::kRepeat;
  }
  const std::pair key(request.client, request.request_id);
  if (std::find(computing_.begin(), computing_.end(), key) != computing_.end()) {
    return Admission::kRepeat;
  }
  const std::size_t open = waiting_.size() + computing_.size();
  if (open >= max_open_) return Admission::kFull;
  const std::size_t cells = offered.cells();
  const auto deadline = offered.deadline();
  if (open > 0 && deadline && offered.arrived + ExpectedWaitLocked(cells) > *deadline) {
    return Admission::kTooSlow;
  }
  open_cells_ += cells;
  waiting_.push_back(std::move(offered));
  changed_.notify_one();
  return Admission::kQueued;
}

std::optional<OpenRequest> RequestQueue::Take() {
  const std::lock_guard lock(mutex_);
  return TakeLocked();
}

std::optional<OpenRequest> RequestQueue::WaitAndTake() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
  return TakeLocked();
}

std::optional<OpenRequest> RequestQueue::TakeLocked() {
  if (waiting_.empty()) return std::nullopt;
  OpenRequest taken = std::move(waiting_.front());
  waiting_.pop_front();
  computing_.emplace_back(taken.request.client, taken.request.request_id);
  return taken;
}

void RequestQueue::Finish(const OpenRequest& taken,
                          std::optional<std::chrono::nanoseconds> computing) {
  const std::size_t cells = taken.cells();
  const std::pair key(taken.request.client, taken.request.request_id);
  const std::lock_guard lock(mutex_);
  std::erase(computing_, key);
  open_cells_ -= cells;
  if (!computing || cells == 0) return;
  const double seconds =
      std::chrono::duration<double>(*computing).count() / static_cast<double>(cells);
  seconds_per_cell_ = seconds_per_cell_ == 0.0
                          ? seconds
                          : seconds_per_cell_ + kWeightOfNewest * (seconds - seconds_per_cell_);
}

void RequestQueue::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::size_t RequestQueue::open() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size() + computing_.size();
}

std::chrono::nanoseconds RequestQueue::ExpectedWait(std::size_t cells) const {
  const std::lock_guard lock(mutex_);
  return ExpectedWaitLocked(cells);
}

std::chrono::nanoseconds RequestQueue::ExpectedWaitLocked(std::size_t cells) const {
  const double ahead = static_cast<double>(open_cells_) / threads_;
  return Seconds((ahead + static_cast<double>(cells)) * seconds_per_cell_);
}

}  // namespace conav::nhpm
