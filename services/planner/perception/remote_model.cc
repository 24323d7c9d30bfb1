#include "planner/perception/remote_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/bus/topics.h"
#include "common/msg/convert.h"
#include "common/runtime/text.h"

namespace conav::planner {

using ReplyMessage = conav_msgs::msg::PerceptionReply;
using RequestMessage = conav_msgs::msg::PerceptionRequest;

// --- one batch -------------------------------------------------------------------------------

OpenRequests::Batch::Batch(OpenRequests& owner, std::vector<RequestMessage> messages)
    : owner_(owner), requests_(messages.size()), missing_(messages.size()) {
  const std::lock_guard lock(owner_.mutex_);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    requests_[i].message = std::move(messages[i]);
    owner_.places_[requests_[i].message.request_id()] = {this, &requests_[i]};
  }
}

OpenRequests::Batch::~Batch() {
  const std::lock_guard lock(owner_.mutex_);
  for (const Request& request : requests_) owner_.places_.erase(request.message.request_id());
}

std::vector<RequestMessage*> OpenRequests::Batch::Unanswered() {
  const std::lock_guard lock(owner_.mutex_);
  std::vector<RequestMessage*> messages;
  const auto& replica = owner_.replica_;
  for (Request& request : requests_) {
    if (request.answers) continue;
    request.message.replica(replica ? replica->name : "");
    request.asked = replica ? std::optional(replica->writer) : std::nullopt;
    messages.push_back(&request.message);
  }
  return messages;
}

OpenRequests::Batch::Outcome OpenRequests::Batch::Wait(TimePoint silence_end,
                                                       std::chrono::nanoseconds pause,
                                                       std::size_t replicas) {
  std::unique_lock lock(owner_.mutex_);
  changed_.wait_until(lock, silence_end, [this] { return missing_ == 0 || declined_; });
  if (missing_ > 0 && declined_) {
    // Another replica may answer meanwhile.
    const TimePoint pause_end = std::min(std::chrono::steady_clock::now() + pause, silence_end);
    changed_.wait_until(lock, pause_end,
                        [&] { return missing_ == 0 || IsRefusedByAllLocked(replicas); });
  }
  const bool declined = std::exchange(declined_, false);
  if (missing_ == 0) return Outcome::kAnswered;
  return declined ? Outcome::kDeclined : Outcome::kSilence;
}

bool OpenRequests::Batch::IsRefusedByAll(std::size_t replicas) {
  const std::lock_guard lock(owner_.mutex_);
  return IsRefusedByAllLocked(replicas);
}

bool OpenRequests::Batch::IsRefusedByAllLocked(std::size_t replicas) const {
  return std::ranges::any_of(requests_, [replicas](const Request& request) {
    return !request.answers && request.refused_by.size() >= replicas;
  });
}

std::optional<Error> OpenRequests::Batch::Reason() {
  const std::lock_guard lock(owner_.mutex_);
  for (const Request& request : requests_) {
    if (!request.busy.empty()) {
      return Error{ErrorCode::kUnavailable, "perception service is busy: " + request.busy};
    }
    if (!request.refusal.empty()) return Error{ErrorCode::kUnavailable, request.refusal};
  }
  return std::nullopt;
}

std::vector<PerceptionAnswer> OpenRequests::Batch::Take() {
  const std::lock_guard lock(owner_.mutex_);
  std::vector<PerceptionAnswer> all;
  for (Request& request : requests_) std::ranges::move(*request.answers, std::back_inserter(all));
  return all;
}

// --- all of them -----------------------------------------------------------------------------

OpenRequests::OpenRequests(Wanted wanted) : wanted_(std::move(wanted)) {
  if (!wanted_.model.empty()) answering_.name = wanted_.model;
}

std::string OpenRequests::ForgetReplica() {
  const std::lock_guard lock(mutex_);
  const auto forgotten = std::exchange(replica_, std::nullopt);
  return forgotten ? forgotten->name : "";
}

ModelIdentity OpenRequests::identity() const {
  const std::lock_guard lock(mutex_);
  return answering_;
}

std::uint64_t OpenRequests::busy() const {
  const std::lock_guard lock(mutex_);
  return busy_;
}

std::uint64_t OpenRequests::unreadable() const {
  const std::lock_guard lock(mutex_);
  return unreadable_;
}

std::uint64_t OpenRequests::unasked() const {
  const std::lock_guard lock(mutex_);
  return unasked_;
}

void OpenRequests::Receive(const ReplyMessage& message, const bus::Guid& writer) {
  if (message.client() != wanted_.client) return;
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(message.request_id());
  if (found == places_.end() || found->second.request->answers) return;
  Place& place = found->second;
  place.writer = writer;
  const auto& asked = place.request->asked;
  if (asked && *asked != writer) return NoteUnaskedLocked(message);
  if (!IsWanted(message)) return NoteOtherModelLocked(place, message);
  if (message.status() == conav_msgs::msg::PerceptionReply_Constants::PERCEPTION_STATUS_BUSY) {
    return NoteBusyLocked(place, message);
  }
  ReadLocked(place, message);
}

bool OpenRequests::IsWanted(const ReplyMessage& message) const {
  return (wanted_.model.empty() || message.model() == wanted_.model) &&
         (wanted_.checksum.empty() || message.model_checksum() == wanted_.checksum);
}

void OpenRequests::ReadLocked(const Place& place, const ReplyMessage& message) {
  const RequestMessage& asked = place.request->message;
  auto reply = ToDomain(message, static_cast<int>(asked.rows()), static_cast<int>(asked.columns()));
  if (!reply) return NoteUnreadableLocked(place, reply.error().text);
  if (reply->status == PerceptionStatus::kRefused) {
    // The queries were checked before they were sent: it is a fault of that service.
    if (const auto held_back = refusals_logged_.Allow()) {
      LOG_WARNING("perception service refused", "replica", reply->replica, "reason", reply->reason,
                  "held_back", *held_back);
    }
    return RefuseLocked(place, "perception service refused: " + reply->reason);
  }
  if (reply->answers.size() != asked.queries().size()) {
    return NoteUnreadableLocked(place,
                                fmt::format("answers has size {}, not that of the queries, {}",
                                            reply->answers.size(), asked.queries().size()));
  }
  NoteModelLocked(*reply);
  replica_ = {reply->replica, place.writer};
  place.request->answers = std::move(reply->answers);
  if (--place.batch->missing_ == 0) place.batch->changed_.notify_one();
}

void OpenRequests::NoteModelLocked(const PerceptionReply& reply) {
  if (answering_.name == reply.model && answering_.checksum == reply.model_checksum) return;
  answering_ = {reply.model, reply.model_version, reply.model_checksum};
  LOG_INFO("perception model answers", "model", reply.model, "version", reply.model_version,
           "checksum", reply.model_checksum, "replica", reply.replica);
}

void OpenRequests::NoteOtherModelLocked(const Place& place, const ReplyMessage& message) {
  if (other_models_logged_.Allow()) {
    LOG_WARNING("reply of another model refused", "replica", message.replica(), "model",
                message.model(), "checksum", message.model_checksum(), "wanted", wanted_.model,
                "wanted_checksum", wanted_.checksum);
  }
  const bool says_why =
      message.status() != conav_msgs::msg::PerceptionReply_Constants::PERCEPTION_STATUS_OK;
  RefuseLocked(place, says_why
                          ? message.reason()
                          : fmt::format("model '{}' {} answered, wanted '{}' {}", message.model(),
                                        message.model_checksum(), wanted_.model, wanted_.checksum));
}

void OpenRequests::NoteBusyLocked(const Place& place, const ReplyMessage& message) {
  ++busy_;
  if (busy_logged_.Allow()) {
    LOG_WARNING("perception service busy", "replica", message.replica(), "reason", message.reason(),
                "count", busy_);
  }
  place.request->busy = message.reason();
  DeclineLocked(place);
}

void OpenRequests::NoteUnreadableLocked(const Place& place, const std::string& reason) {
  ++unreadable_;
  if (unreadable_logged_.Allow()) {
    LOG_WARNING("message refused", "topic", bus::kPerceptionReply.pattern, "reason", reason,
                "count", unreadable_);
  }
  RefuseLocked(place, "perception reply: " + reason);
}

void OpenRequests::NoteUnaskedLocked(const ReplyMessage& message) {
  ++unasked_;
  if (unasked_logged_.Allow()) {
    LOG_WARNING("perception reply of a program that was not asked is ignored", "replica",
                message.replica(), "asked", replica_ ? replica_->name : "", "count", unasked_);
  }
}

void OpenRequests::RefuseLocked(const Place& place, const std::string& reason) {
  place.request->refused_by.insert(place.writer);
  place.request->refusal = reason;
  DeclineLocked(place);
}

void OpenRequests::DeclineLocked(const Place& place) {
  if (replica_ && replica_->writer == place.writer) replica_.reset();
  place.batch->declined_ = true;
  place.batch->changed_.notify_one();
}

namespace {

using SteadyTime = std::chrono::steady_clock;

// Well inside what the service takes in one request.
constexpr std::size_t kMaxBatch = 256;
constexpr std::size_t kMaxValues = 1U << 22;

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

RemotePerceptionModel::RemotePerceptionModel(bus::Participant& participant, const Options& options)
    : options_(options),
      client_(participant.node_name() + "-" + UniqueId()),
      open_({client_, options.model, options.model_checksum}),
      requests_(participant, bus::kPerceptionRequest),
      replies_(participant, bus::kPerceptionReply, {},
               [this](ReplyMessage&& message, const bus::Origin& origin) {
                 open_.Receive(message, origin.writer);
               }) {}

Result<std::vector<PerceptionAnswer>> RemotePerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  if (queries.empty()) return std::vector<PerceptionAnswer>();
  OpenRequests::Batch batch(open_, MakeRequests(queries));
  return AskUntilAnswered(batch).map([&batch] { return batch.Take(); });
}

std::vector<conav_msgs::msg::PerceptionRequest> RemotePerceptionModel::MakeRequests(
    std::span<const PerceptionQuery> queries) {
  std::vector<conav_msgs::msg::PerceptionRequest> requests;
  while (!queries.empty()) {
    const auto part = queries.first(BatchSize(queries));
    queries = queries.subspan(part.size());
    requests.push_back(ToMessage(PerceptionRequest{.client = client_,
                                                   .request_id = ++last_request_id_,
                                                   .model = options_.model,
                                                   .model_checksum = options_.model_checksum,
                                                   .person = options_.person,
                                                   .queries = {part.begin(), part.end()}}));
  }
  return requests;
}

Result<void> RemotePerceptionModel::AskUntilAnswered(OpenRequests::Batch& batch) {
  using Outcome = OpenRequests::Batch::Outcome;
  const TimePoint deadline = SteadyTime::now() + options_.timeout;
  while (true) {
    if (ServiceIsGone()) {
      return Fail(ErrorCode::kUnavailable, "no perception service is on the bus");
    }
    const auto sent = Send(batch, deadline);  // a full bus has room again at times
    const auto next_send = std::min(SteadyTime::now() + options_.retry_interval, deadline);
    const Outcome outcome = batch.Wait(next_send, options_.busy_pause, Replicas());
    if (outcome == Outcome::kAnswered) return {};
    if (SteadyTime::now() >= deadline || batch.IsRefusedByAll(Replicas())) {
      return sent ? tl::unexpected(NoAnswer(batch)) : sent;
    }
    if (outcome == Outcome::kSilence) NoteSilence();
  }
}

Result<void> RemotePerceptionModel::Send(OpenRequests::Batch& batch, TimePoint deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - SteadyTime::now()).count();
  for (conav_msgs::msg::PerceptionRequest* request : batch.Unanswered()) {
    request->timeout_ms(static_cast<std::uint32_t>(std::max<std::int64_t>(left, 1)));
    if (auto sent = requests_.Publish(*request); !sent) return sent;
  }
  return {};
}

void RemotePerceptionModel::NoteSilence() {
  ++repeats_;
  const std::string replica = open_.ForgetReplica();
  if (replica.empty()) return;
  if (const auto held_back = silence_logged_.Allow()) {
    LOG_WARNING("perception replica did not answer, asking all", "replica", replica, "held_back",
                *held_back);
  }
}

bool RemotePerceptionModel::ServiceIsGone() {
  if (replies_.matched_publishers() > 0) {
    discovered_ = true;
    return false;
  }
  return discovered_;
}

std::size_t RemotePerceptionModel::Replicas() const {
  return static_cast<std::size_t>(std::max(replies_.matched_publishers(), 1));
}

Error RemotePerceptionModel::NoAnswer(OpenRequests::Batch& batch) {
  discovered_ = true;  // later batches do not wait for a service that never came
  return batch.Reason().value_or(Error{
      ErrorCode::kTimeout, fmt::format("no reply of a perception service within {} s",
                                       std::chrono::duration<double>(options_.timeout).count())});
}

}  // namespace conav::planner
