#include "nhpm/nhpm_service.h"

#include <fmt/format.h>

#include <bit>
#include <thread>
#include <vector>

#include "common/bus/send.h"
#include "common/runtime/log.h"

namespace conav::nhpm {
namespace {

constexpr std::chrono::milliseconds kReceivePause{100};
constexpr std::chrono::seconds kRefreshPeriod{1};

/// The first, second, fourth, ... of many equal log lines.
bool WorthLogging(std::uint64_t count) { return std::has_single_bit(count); }

double Milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// Why the asker does not want `identity`; empty when it does.
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
      return SendWithout(open.request, PerceptionStatus::kBusy,
                         fmt::format("an answer takes {:.0f} ms, wanted within {} ms",
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
        fmt::format("waited longer than {} ms for its turn", open.request.timeout_ms));
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

/// Counted first: who has the reply finds it in the counts.
void NhpmService::Send(const PerceptionReply& reply) {
  Count(reply);
  bus::Send(replies_, ToMessage(reply));
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
