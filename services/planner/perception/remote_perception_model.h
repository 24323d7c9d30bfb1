#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/log_limit.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// Asks the nhpm service over the bus; the first replica that replies answers.
///
/// A batch becomes one request (several when beliefs differ in shape or there are very many),
/// addressed to the replica that answered last, so that a request is computed once. One that is not
/// answered is repeated after `retry_interval`, one that is answered "busy" after `busy_pause`,
/// both to all replicas: a service answers a repeat alike, and the first good reply counts.
/// A reply of another model than the one wanted is refused, which is logged.
/// Errors:  kInvalidArgument (a bad query; nobody was asked), kTimeout (no reply within `timeout`),
///          kUnavailable (the service is gone, busy for the whole time, or refused the request; the
///          bus stays full; only other models are served; a reply cannot be read, which is logged). A
///          service that was never seen is waited for during the first batch only.
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
  std::string name() const override;
  /// Name and checksum of the model that replied last.
  std::string identity() const override;

  /// Requests sent again because no reply came in time.
  std::uint64_t repeats() const { return repeats_.load(); }
  /// Replies "busy".
  std::uint64_t busy() const { return busy_.load(); }
  /// Replies that could not be read.
  std::uint64_t refused() const { return refused_.load(); }

 private:
  using TimePoint = std::chrono::steady_clock::time_point;
  struct Call;
  struct Waiter;

  std::vector<Call> MakeCalls(std::span<const PerceptionQuery> queries, Waiter& waiter);
  Result<void> Ask(std::vector<Call>& calls, Waiter& waiter);
  Result<void> AskUntilReplied(std::vector<Call>& calls, Waiter& waiter);
  /// Waits for the replies until it is time to send again; true when all are there.
  bool WaitForReplies(Waiter& waiter, TimePoint deadline);
  Result<void> Send(std::vector<Call>& calls, TimePoint deadline);
  /// Stops addressing the replica that left requests unanswered.
  void ForgetReplica();
  bool ServiceIsGone();
  /// Whether every replica that is there serves something else than what is wanted.
  bool OnlyOtherModels(const std::vector<Call>& calls);
  Error NoReply(const std::vector<Call>& calls);
  /// On the bus's receive thread.
  void Receive(conav_msgs::msg::PerceptionReply&& message);
  bool IsWanted(const conav_msgs::msg::PerceptionReply& message) const;
  void NoteOtherModel(Call& call, const conav_msgs::msg::PerceptionReply& message);
  void NoteBusy(Call& call, const conav_msgs::msg::PerceptionReply& message);
  Result<void> Collect(const Call& call, std::vector<PerceptionAnswer>& answers);
  Result<void> RefuseReply(const std::string& reason);

  std::string client_;
  Options options_;
  std::atomic<std::uint64_t> last_request_id_{0};
  std::atomic<std::uint64_t> repeats_{0};
  std::atomic<std::uint64_t> busy_{0};
  std::atomic<std::uint64_t> refused_{0};
  LogLimit refusals_logged_;
  LogLimit other_models_logged_{std::chrono::seconds(10)};
  LogLimit busy_logged_{std::chrono::seconds(10)};
  std::atomic<bool> discovered_{false};            // a service was seen, or none came in time
  mutable std::mutex mutex_;                       // guards all below
  std::unordered_map<std::uint64_t, Call*> open_;  // and the calls themselves
  std::string answering_model_ = "remote";
  std::string answering_checksum_;
  std::string replica_;  // that answered last; empty = all are asked
  bus::Publisher<conav_msgs::msg::PerceptionRequest> requests_;
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies_;  // last: its thread uses the rest
};

}  // namespace conav::planner
