#include "planner/perception/remote_perception_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/protocol/convert.h"
#include "common/runtime/log.h"

namespace conav::planner {
namespace {

using SteadyTime = std::chrono::steady_clock;

// Well inside what the service takes in one request.
constexpr std::size_t kMaxBatch = 256;
constexpr std::size_t kMaxValues = 1U << 22;

/// Unique among all processes, also after a restart: replies to somebody else are ignored.
std::string UniqueClient(const std::string& node_name) {
  std::random_device entropy;
  return fmt::format("{}-{:08x}{:08x}", node_name, entropy(), entropy());
}

/// How many of `queries`, from the first on, go into one request.
std::size_t BatchSize(std::span<const PerceptionQuery> queries) {
  const BeliefGrid& first = queries.front().belief;
  const std::size_t limit = std::clamp<std::size_t>(kMaxValues / first.size(), 1, kMaxBatch);
  std::size_t size = 1;
  while (size < std::min(limit, queries.size()) && queries[size].belief.rows() == first.rows() &&
         queries[size].belief.columns() == first.columns()) {
    ++size;
  }
  return size;
}

}  // namespace

/// One thread in Predict().
struct RemotePerceptionModel::Waiter {
  std::condition_variable changed;
  std::size_t missing = 0;
  bool declined = false;  // a replica is busy or serves another model, since the last sending
};

/// One request that waits for its reply.
struct RemotePerceptionModel::Call {
  std::span<const PerceptionQuery> queries;
  conav_msgs::msg::PerceptionRequest request;
  std::optional<conav_msgs::msg::PerceptionReply> reply;
  std::set<std::string> other_models;  // replicas that serve something else
  std::string other_model;             // what the last of them said
  std::string busy;                    // what the last busy replica said
  Waiter* waiter = nullptr;
};

RemotePerceptionModel::RemotePerceptionModel(bus::Participant& participant, const Options& options)
    : client_(UniqueClient(participant.node_name())),
      options_(options),
      requests_(participant, bus::kPerceptionRequest),
      replies_(
          participant, bus::kPerceptionReply, {},
          [this](conav_msgs::msg::PerceptionReply&& message) { Receive(std::move(message)); }) {
  if (!options_.model.empty()) answering_model_ = options_.model;
}

std::string RemotePerceptionModel::name() const {
  const std::lock_guard lock(mutex_);
  return answering_model_;
}

std::string RemotePerceptionModel::identity() const {
  const std::lock_guard lock(mutex_);
  return answering_model_ + " " + answering_checksum_;
}

Result<std::vector<PerceptionAnswer>> RemotePerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  std::vector<PerceptionAnswer> answers;
  if (queries.empty()) return answers;
  Waiter waiter;
  std::vector<Call> calls = MakeCalls(queries, waiter);
  if (const auto asked = Ask(calls, waiter); !asked) return tl::unexpected(asked.error());
  answers.reserve(queries.size());
  for (const Call& call : calls) {
    if (const auto collected = Collect(call, answers); !collected) {
      return tl::unexpected(collected.error());
    }
  }
  return answers;
}

std::vector<RemotePerceptionModel::Call> RemotePerceptionModel::MakeCalls(
    std::span<const PerceptionQuery> queries, Waiter& waiter) {
  std::vector<Call> calls;
  while (!queries.empty()) {
    const auto batch = queries.first(BatchSize(queries));
    queries = queries.subspan(batch.size());
    Call& call = calls.emplace_back();
    call.queries = batch;
    call.waiter = &waiter;
    call.request = ToMessage(PerceptionRequest{.client = client_,
                                               .request_id = ++last_request_id_,
                                               .model = options_.model,
                                               .model_checksum = options_.model_checksum,
                                               .person = options_.person,
                                               .queries = {batch.begin(), batch.end()}});
  }
  waiter.missing = calls.size();
  return calls;
}

Result<void> RemotePerceptionModel::Ask(std::vector<Call>& calls, Waiter& waiter) {
  {
    const std::lock_guard lock(mutex_);
    for (Call& call : calls) open_[call.request.request_id()] = &call;
  }
  const auto asked = AskUntilReplied(calls, waiter);
  const std::lock_guard lock(mutex_);
  for (const Call& call : calls) open_.erase(call.request.request_id());
  return asked;
}

Result<void> RemotePerceptionModel::AskUntilReplied(std::vector<Call>& calls, Waiter& waiter) {
  const TimePoint deadline = SteadyTime::now() + options_.timeout;
  while (true) {
    if (ServiceIsGone()) {
      return Fail(ErrorCode::kUnavailable, "no perception service is on the bus");
    }
    const auto sent = Send(calls, deadline);  // a full bus has room again at times
    if (WaitForReplies(waiter, deadline)) return {};
    if (SteadyTime::now() >= deadline || OnlyOtherModels(calls)) {
      return sent ? tl::unexpected(NoReply(calls)) : sent;
    }
    ForgetReplica();
    ++repeats_;
  }
}

bool RemotePerceptionModel::WaitForReplies(Waiter& waiter, TimePoint deadline) {
  std::unique_lock lock(mutex_);
  const auto replied = [&waiter] { return waiter.missing == 0; };
  const auto next_send = std::min(SteadyTime::now() + options_.retry_interval, deadline);
  waiter.changed.wait_until(lock, next_send,
                            [&waiter] { return waiter.missing == 0 || waiter.declined; });
  if (!replied() && waiter.declined) {
    // Another replica may answer meanwhile.
    const auto pause_end = std::min(SteadyTime::now() + options_.busy_pause, deadline);
    waiter.changed.wait_until(lock, pause_end, replied);
  }
  waiter.declined = false;
  return replied();
}

/// Sends what has no reply yet.
Result<void> RemotePerceptionModel::Send(std::vector<Call>& calls, TimePoint deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - SteadyTime::now()).count();
  std::vector<Call*> unanswered;
  std::string replica;
  {
    const std::lock_guard lock(mutex_);
    replica = replica_;
    for (Call& call : calls) {
      if (!call.reply) unanswered.push_back(&call);
    }
  }
  // Without the lock: an in-memory bus may reply before Publish() returns.
  for (Call* call : unanswered) {
    call->request.replica(replica);
    call->request.timeout_ms(static_cast<std::uint32_t>(std::max<std::int64_t>(left, 1)));
    if (auto sent = requests_.Publish(call->request); !sent) return sent;
  }
  return {};
}

void RemotePerceptionModel::ForgetReplica() {
  std::string forgotten;
  {
    const std::lock_guard lock(mutex_);
    forgotten.swap(replica_);
  }
  if (forgotten.empty()) return;
  LOG_WARNING("perception replica did not answer, asking all", "replica", forgotten);
}

bool RemotePerceptionModel::ServiceIsGone() {
  if (replies_.matched_publishers() > 0) {
    discovered_ = true;
    return false;
  }
  return discovered_;
}

bool RemotePerceptionModel::OnlyOtherModels(const std::vector<Call>& calls) {
  const auto replicas = static_cast<std::size_t>(std::max(replies_.matched_publishers(), 1));
  const std::lock_guard lock(mutex_);
  return std::any_of(calls.begin(), calls.end(), [replicas](const Call& call) {
    return !call.reply && call.other_models.size() >= replicas;
  });
}

Error RemotePerceptionModel::NoReply(const std::vector<Call>& calls) {
  discovered_ = true;  // later batches do not wait for a service that never came
  const std::lock_guard lock(mutex_);
  for (const Call& call : calls) {
    if (!call.busy.empty()) {
      return {ErrorCode::kUnavailable, "perception service is busy: " + call.busy};
    }
    if (!call.other_model.empty()) return {ErrorCode::kUnavailable, call.other_model};
  }
  return {ErrorCode::kTimeout,
          fmt::format("no reply of a perception service within {} s",
                      std::chrono::duration<double>(options_.timeout).count())};
}

void RemotePerceptionModel::Receive(conav_msgs::msg::PerceptionReply&& message) {
  if (message.client() != client_) return;
  const std::lock_guard lock(mutex_);
  const auto found = open_.find(message.request_id());
  if (found == open_.end() || found->second->reply) return;
  Call& call = *found->second;
  if (!IsWanted(message)) return NoteOtherModel(call, message);
  if (message.status() == conav_msgs::msg::PERCEPTION_STATUS_BUSY) return NoteBusy(call, message);
  answering_model_ = message.model();
  answering_checksum_ = message.model_checksum();
  replica_ = message.replica();
  call.reply = std::move(message);
  if (--call.waiter->missing == 0) call.waiter->changed.notify_one();
}

bool RemotePerceptionModel::IsWanted(const conav_msgs::msg::PerceptionReply& message) const {
  return (options_.model.empty() || message.model() == options_.model) &&
         (options_.model_checksum.empty() || message.model_checksum() == options_.model_checksum);
}

void RemotePerceptionModel::NoteOtherModel(Call& call,
                                           const conav_msgs::msg::PerceptionReply& message) {
  const bool says_why = message.status() != conav_msgs::msg::PERCEPTION_STATUS_OK;
  call.other_models.insert(message.replica());
  call.other_model =
      says_why ? message.reason()
               : fmt::format("model '{}' {} answered, wanted '{}' {}", message.model(),
                             message.model_checksum(), options_.model, options_.model_checksum);
  call.waiter->declined = true;
  call.waiter->changed.notify_one();
  if (!other_models_logged_.Allow()) return;
  LOG_WARNING("reply of another model refused", "replica", message.replica(), "model",
              message.model(), "checksum", message.model_checksum(), "wanted", options_.model,
              "wanted_checksum", options_.model_checksum);
}

void RemotePerceptionModel::NoteBusy(Call& call, const conav_msgs::msg::PerceptionReply& message) {
  const std::uint64_t count = ++busy_;
  call.busy = message.reason();
  call.waiter->declined = true;
  call.waiter->changed.notify_one();
  if (!busy_logged_.Allow()) return;
  LOG_WARNING("perception service busy", "replica", message.replica(), "reason", message.reason(),
              "count", count);
}

/// `call` has a reply and is no longer open. The queries were checked before they were sent, so a
/// refusal is a fault of that service, which somebody else may not have.
Result<void> RemotePerceptionModel::Collect(const Call& call,
                                            std::vector<PerceptionAnswer>& answers) {
  const BeliefGrid& belief = call.queries.front().belief;
  auto reply = ToDomain(*call.reply, belief.rows(), belief.columns());
  if (!reply) return RefuseReply(reply.error().text);
  if (reply->status == PerceptionStatus::kRefused) {
    return Fail(ErrorCode::kUnavailable, "perception service refused: " + reply->reason);
  }
  if (reply->answers.size() != call.queries.size()) {
    return RefuseReply(fmt::format("answers has size {}, not that of the queries, {}",
                                   reply->answers.size(), call.queries.size()));
  }
  std::move(reply->answers.begin(), reply->answers.end(), std::back_inserter(answers));
  return {};
}

Result<void> RemotePerceptionModel::RefuseReply(const std::string& reason) {
  const std::uint64_t count = ++refused_;
  if (refusals_logged_.Allow()) {
    LOG_WARNING("message refused", "topic", bus::kPerceptionReply.pattern, "reason", reason,
                "count", count);
  }
  return Fail(ErrorCode::kUnavailable, "perception reply: " + reason);
}

}  // namespace conav::planner
