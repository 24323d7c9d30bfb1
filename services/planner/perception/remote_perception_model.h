#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/log_limit.h"
#include "planner/perception/open_requests.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// Asks the nhpm service over the bus; the first replica that replies answers.
///
/// A batch becomes one request (several when beliefs differ in shape or there are very many),
/// addressed to the replica that answered last, so that a request is computed once. One that is not
/// answered is repeated after `retry_interval`, one that a replica declines (OpenRequests) after
/// `busy_pause`, both to all replicas: a service answers a repeat alike, and the first good reply
/// counts. Silence and replies that are of no use are logged.
/// Errors:  kInvalidArgument (a bad query; nobody was asked), kTimeout (no reply within `timeout`),
///          kUnavailable (the service is gone, or busy for the whole time; each replica refused the
///          request, serves another model or cannot be understood; the bus stays full). A service
///          that was never seen is waited for during the first batch only.
/// Threads: as PerceptionModel. A reply wakes its caller directly from the bus's receive thread.
class RemotePerceptionModel final : public PerceptionModel {
 public:
  struct Options {
    std::string model;           // name wanted; empty = whatever is served
    std::string model_checksum;  // SHA-256 wanted; empty = any
    std::string person;          // whose edits; empty = the average operator's
    std::chrono::nanoseconds timeout = std::chrono::seconds(2);
    std::chrono::nanoseconds retry_interval = std::chrono::milliseconds(250);
    std::chrono::nanoseconds busy_pause = std::chrono::milliseconds(50);
  };

  RemotePerceptionModel(bus::Participant& participant, const Options& options);

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  /// The model wanted, or the one that replied last, or "remote" before any did.
  std::string name() const override { return open_.model(); }
  /// Name and checksum of the model that replied last.
  std::string identity() const override { return open_.identity(); }

  /// How often requests were sent again because no reply came in time.
  std::uint64_t repeats() const { return repeats_.load(); }
  /// Replies "busy".
  std::uint64_t busy() const { return open_.busy(); }
  /// Replies that could not be understood.
  std::uint64_t refused() const { return open_.unreadable(); }

 private:
  using TimePoint = OpenRequests::TimePoint;

  std::vector<conav_msgs::msg::PerceptionRequest> MakeRequests(
      std::span<const PerceptionQuery> queries);
  Result<void> AskUntilAnswered(OpenRequests::Batch& batch);
  /// Sends what has no answer yet.
  Result<void> Send(OpenRequests::Batch& batch, TimePoint deadline);
  /// Stops addressing the replica that left requests unanswered.
  void NoteSilence();
  bool ServiceIsGone();
  /// As far as the bus knows, at least 1.
  std::size_t Replicas() const;
  Error NoAnswer(OpenRequests::Batch& batch);

  const Options options_;
  const std::string client_;
  std::atomic<std::uint64_t> last_request_id_{0};
  std::atomic<std::uint64_t> repeats_{0};
  std::atomic<bool> discovered_{false};  // a service was seen, or none came in time
  LogLimit silence_logged_{std::chrono::seconds(10)};
  OpenRequests open_;
  bus::Publisher<conav_msgs::msg::PerceptionRequest> requests_;
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies_;  // last: its thread uses the rest
};

}  // namespace conav::planner
