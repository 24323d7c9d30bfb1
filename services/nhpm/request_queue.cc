#include "nhpm/request_queue.h"

#include <algorithm>

namespace conav::nhpm {
namespace {

using Message = conav_msgs::msg::PerceptionRequest;

constexpr double kWeightOfNewest = 0.1;

bool IsSame(const Message& a, const Message& b) {
  return a.request_id() == b.request_id() && a.client() == b.client();
}

}  // namespace

std::optional<Clock::TimePoint> OpenRequest::deadline() const {
  if (message.timeout_ms() == 0) return std::nullopt;
  return arrived + std::chrono::milliseconds(message.timeout_ms());
}

RequestQueue::Admission RequestQueue::Offer(OpenRequest&& request) {
  const Message& message = request.message;
  const std::lock_guard lock(mutex_);
  for (OpenRequest& open : waiting_) {
    if (!IsSame(open.message, message)) continue;
    open.message.timeout_ms(message.timeout_ms());
    open.arrived = request.arrived;
    return Admission::kRepeat;
  }
  const std::pair key(message.client(), message.request_id());
  if (std::find(computing_.begin(), computing_.end(), key) != computing_.end()) {
    return Admission::kRepeat;
  }
  if (waiting_.size() + computing_.size() >= max_open_) return Admission::kFull;
  const auto deadline = request.deadline();
  if (deadline && request.arrived + ExpectedWaitLocked(message.queries().size()) > *deadline) {
    return Admission::kTooSlow;
  }
  open_queries_ += message.queries().size();
  waiting_.push_back(std::move(request));
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
  OpenRequest request = std::move(waiting_.front());
  waiting_.pop_front();
  computing_.emplace_back(request.message.client(), request.message.request_id());
  return request;
}

void RequestQueue::Finish(const OpenRequest& request,
                          std::optional<std::chrono::nanoseconds> computing) {
  const std::size_t queries = request.message.queries().size();
  const std::pair key(request.message.client(), request.message.request_id());
  const std::lock_guard lock(mutex_);
  std::erase(computing_, key);
  open_queries_ -= queries;
  if (!computing || queries == 0) return;
  const double seconds =
      std::chrono::duration<double>(*computing).count() / static_cast<double>(queries);
  seconds_per_query_ = seconds_per_query_ == 0.0
                           ? seconds
                           : seconds_per_query_ + kWeightOfNewest * (seconds - seconds_per_query_);
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

std::chrono::nanoseconds RequestQueue::ExpectedWait(std::size_t queries) const {
  const std::lock_guard lock(mutex_);
  return ExpectedWaitLocked(queries);
}

std::chrono::nanoseconds RequestQueue::ExpectedWaitLocked(std::size_t queries) const {
  return Seconds(static_cast<double>(open_queries_ + queries) * seconds_per_query_ / threads_);
}

}  // namespace conav::nhpm
