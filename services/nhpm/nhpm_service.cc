#include "nhpm/nhpm_service.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "common/runtime/log.h"

namespace conav::nhpm {
namespace {

constexpr double kWeightOfNewest = 0.1;

bool IsSame(const PerceptionRequest& a, const PerceptionRequest& b) {
  return a.request_id == b.request_id && a.client == b.client;
}

constexpr std::chrono::milliseconds kReceivePause{100};
constexpr std::chrono::seconds kRefreshPeriod{1};

/// True for the first, second, fourth, ... of many equal log lines.
bool WorthLogging(std::uint64_t count) { return std::has_single_bit(count); }

double Milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// Why the client rejects `identity`; empty if it accepts it.
std::string Mismatch(const PerceptionRequest& request, const ModelIdentity& identity) {
  if (!request.model.empty() && request.model != identity.name) {
    return fmt::format("model = '{}' is not served here, '{}' is", request.model, identity.name);
  }
  if (!request.model_checksum.empty() && request.model_checksum != identity.checksum) {
    return fmt::format("model_checksum = {} is not served here, {} is", request.model_checksum,
                       identity.checksum);
  }
  return "";
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

NhpmService::NhpmService(bus::Participant& participant, const NhpmConfig& config,
                         const Clock& clock)
    : participant_(participant),
      clock_(clock),
      threads_(config.threads),
      models_(config),
      next_refresh_(clock.Now() + kRefreshPeriod),
      queue_(static_cast<std::size_t>(config.max_open), config.threads),
      diagnostics_(participant, clock),
      replies_(participant, bus::kPerceptionReply),
      predictions_(participant, bus::kPredictionReply),
      requests_(participant, bus::kPerceptionRequest) {}

void NhpmService::Run(const StopToken& stop) {
  struct ClosedAtEnd {
    RequestQueue& queue;
    ~ClosedAtEnd() { queue.Close(); }
  };
  std::vector<std::jthread> threads;
  const ClosedAtEnd closed_before_threads_are_joined{queue_};
  for (int i = 0; i < threads_; ++i) {
    threads.emplace_back([this] {
      while (const auto open = queue_.WaitAndTake()) Answer(*open);
    });
  }
  while (!stop.stop_requested()) Receive(kReceivePause);
}

void NhpmService::Receive(std::chrono::nanoseconds timeout) {
  participant_.Wait(timeout);
  for (const auto& message : requests_.Take()) Admit(message);
  RefreshModels();
  diagnostics_.Tick([this] { return Report(); });
}

void NhpmService::AnswerOpen() {
  while (const auto open = queue_.Take()) Answer(*open);
}

NhpmService::Counts NhpmService::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void NhpmService::RefreshModels() {
  if (clock_.Now() < next_refresh_) return;
  next_refresh_ = clock_.Now() + kRefreshPeriod;
  models_.Refresh();
}

void NhpmService::Admit(const conav_msgs::msg::PerceptionRequest& message) {
  const auto sender = SenderOf(message);
  if (!sender) return Drop(sender.error().text);
  if (!message.replica().empty() && message.replica() != participant_.node_name()) return;
  auto request = ToDomain(message);
  if (!request) return SendWithout(*sender, PerceptionStatus::kRefused, request.error().text);
  OpenRequest open{*std::move(request), clock_.Now()};
  switch (queue_.Offer(std::move(open))) {
    case RequestQueue::Admission::kQueued:
    case RequestQueue::Admission::kRepeat:
      return;
    case RequestQueue::Admission::kFull:
      return SendWithout(open.request, PerceptionStatus::kBusy,
                         fmt::format("{} requests are open", queue_.open()));
    case RequestQueue::Admission::kTooSlow: {
      const auto wait = queue_.ExpectedWait(open.cells());
      return SendWithout(
          open.request, PerceptionStatus::kBusy,
          fmt::format("an answer takes {:.0f} ms, more than the {} ms of the request",
                      Milliseconds(wait), open.request.timeout_ms));
    }
  }
}

void NhpmService::Drop(const std::string& reason) {
  std::unique_lock lock(mutex_);
  const std::uint64_t count = ++counts_.dropped;
  lock.unlock();
  if (!WorthLogging(count)) return;
  LOG_WARNING("request dropped", "topic", bus::kPerceptionRequest.pattern, "reason", reason,
              "count", count);
}

void NhpmService::SendWithout(const PerceptionRequest& request, PerceptionStatus status,
                              std::string reason) {
  PerceptionReply reply = Blank(request, models_.For(request.person)->identity());
  reply.status = status;
  reply.reason = std::move(reason);
  Send(reply);
}

void NhpmService::Answer(const OpenRequest& open) {
  const Clock::TimePoint start = clock_.Now();
  if (const auto deadline = open.deadline(); deadline && start >= *deadline) {
    queue_.Finish(open, std::nullopt);
    {
      const std::lock_guard lock(mutex_);
      ++counts_.late;
    }
    return SendWithout(
        open.request, PerceptionStatus::kBusy,
        fmt::format("waited in the queue for more than {} ms", open.request.timeout_ms));
  }
  const PerceptionReply reply = ReplyTo(open.request);
  Send(reply);
  const std::chrono::nanoseconds computing = clock_.Now() - start;
  const bool computed = reply.status == PerceptionStatus::kOk;
  queue_.Finish(open, computed ? std::optional(computing) : std::nullopt);
  const std::lock_guard lock(mutex_);
  counts_.computing += computing;
}

PerceptionReply NhpmService::Blank(const PerceptionRequest& request,
                                   const ModelIdentity& identity) const {
  PerceptionReply reply;
  reply.client = request.client;
  reply.request_id = request.request_id;
  reply.replica = participant_.node_name();
  reply.model = identity.name;
  reply.model_version = identity.version;
  reply.model_checksum = identity.checksum;
  return reply;
}

PerceptionReply NhpmService::ReplyTo(const PerceptionRequest& request) const {
  const auto model = models_.For(request.person);
  PerceptionReply reply = Blank(request, model->identity());
  reply.reason = Mismatch(request, model->identity());
  if (reply.reason.empty()) {
    if (auto answers = model->Predict(request.queries)) {
      reply.answers = *std::move(answers);
      return reply;
    } else {
      reply.reason = answers.error().text;
    }
  }
  reply.status = PerceptionStatus::kRefused;
  return reply;
}

/// Counts first: a client that has the reply finds it in the counts.
void NhpmService::Send(const PerceptionReply& reply) {
  Count(reply);
  bus::Send(reply.client.starts_with(bus::kConsoleClient) ? predictions_ : replies_,
            ToMessage(reply));
}

void NhpmService::Count(const PerceptionReply& reply) {
  std::unique_lock lock(mutex_);
  if (reply.status == PerceptionStatus::kOk) {
    ++counts_.requests;
    counts_.queries += reply.answers.size();
    return;
  }
  const bool busy = reply.status == PerceptionStatus::kBusy;
  const std::uint64_t count = ++(busy ? counts_.busy : counts_.refused);
  lock.unlock();
  if (!WorthLogging(count)) return;
  LOG_WARNING(busy ? "request answered busy" : "request refused", "topic",
              bus::kPerceptionRequest.pattern, "client", reply.client, "request", reply.request_id,
              "reason", reply.reason, "count", count);
}

Health NhpmService::Report() const {
  const ModelIdentity identity = models_.For("")->identity();
  const Counts counts = this->counts();
  return {Health::Level::kOk,
          fmt::format("serving {}", identity.name),
          {{"model", identity.name},
           {"model_version", identity.version},
           {"model_checksum", identity.checksum},
           {"persons", fmt::format("{}", models_.persons())},
           {"open", fmt::format("{}", queue_.open())},
           {"requests", fmt::format("{}", counts.requests)},
           {"queries", fmt::format("{}", counts.queries)},
           {"refused", fmt::format("{}", counts.refused)},
           {"busy", fmt::format("{}", counts.busy)},
           {"late", fmt::format("{}", counts.late)},
           {"dropped", fmt::format("{}", counts.dropped + requests_.malformed())},
           {"computing_s", fmt::format("{:.3f}", Milliseconds(counts.computing) / 1000.0)}}};
}

}  // namespace conav::nhpm
