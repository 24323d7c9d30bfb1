#include "planner/perception/remote_perception_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

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

RemotePerceptionModel::RemotePerceptionModel(bus::Participant& participant, const Options& options)
    : options_(options),
      client_(UniqueClient(participant.node_name())),
      open_({client_, options.model, options.model_checksum}),
      requests_(participant, bus::kPerceptionRequest),
      replies_(participant, bus::kPerceptionReply, {},
               [this](conav_msgs::msg::PerceptionReply&& message) { open_.Receive(message); }) {}

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
  const std::string replica = open_.replica();
  for (conav_msgs::msg::PerceptionRequest* request : batch.Unanswered()) {
    request->replica(replica);
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
