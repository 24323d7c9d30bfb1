#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/perception_model.h"
#include "common/msg/planning.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"
#include "conav_msgs.h"

// One user: the service; apart because it knows the bus.

namespace conav::planner {

/// Requests that wait for replies, and what the replies tell of who answers.
///
/// The first good reply to a request counts. A request that is addressed to a replica is answered by
/// the writer of that replica's last good reply only: a name in a reply proves nothing. A replica
/// that is busy, refuses, serves another model than the one wanted, or cannot be understood has
/// declined: its reason is kept and logged, and the request stays open for the others.
/// Threads: safe to call concurrently; a batch belongs to one thread.
class OpenRequests {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Wanted {
    std::string client;    // replies to others are ignored
    std::string model;     // empty = any
    std::string checksum;  // empty = any
  };

  struct Request {
    conav_msgs::msg::PerceptionRequest message;
    std::optional<bus::Guid> asked;  // the writer that it is addressed to; none = all
    std::optional<std::vector<PerceptionAnswer>> answers;
    std::set<bus::Guid> refused_by;  // writers that will not answer a repeat either
    std::string refusal;             // why the last of them will not
    std::string busy;                // what the last busy replica said
  };

  /// The requests of one thread, open as long as this object lives.
  class Batch {
   public:
    /// `owner` outlives it. The messages' request_id are unique.
    Batch(OpenRequests& owner, std::vector<conav_msgs::msg::PerceptionRequest> messages);
    ~Batch();
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;

    /// To be sent, also again, addressed to the replica of the last good reply; they stay where they are.
    std::vector<conav_msgs::msg::PerceptionRequest*> Unanswered();
    enum class Outcome { kAnswered, kDeclined, kSilence };
    /// Waits until all are answered or `silence_end`; once somebody declined, until `pause` later,
    /// unless all `replicas` refused.
    Outcome Wait(TimePoint silence_end, std::chrono::nanoseconds pause, std::size_t replicas);
    /// Whether one is open that as many as `replicas` refused.
    bool IsRefusedByAll(std::size_t replicas);
    /// Why there is no answer, if a replica said it: kUnavailable.
    std::optional<Error> Reason();
    /// All answers, in order. Call once, after Outcome::kAnswered.
    std::vector<PerceptionAnswer> Take();

   private:
    friend class OpenRequests;
    bool IsRefusedByAllLocked(std::size_t replicas) const;

    OpenRequests& owner_;
    std::vector<Request> requests_;
    std::size_t missing_;
    bool declined_ = false;  // since the last Wait()
    std::condition_variable changed_;
  };

  explicit OpenRequests(Wanted wanted);

  /// Takes in a reply. Wakes its batch when that is complete or declined.
  void Receive(const conav_msgs::msg::PerceptionReply& message, const bus::Guid& writer);

  /// Addresses the next requests to all; returns the name of the replica that gave the last good reply,
  /// empty if none did, or it declined since.
  std::string ForgetReplica();
  /// Of the model that gave the last good reply; before, the name of the model wanted, or "remote".
  ModelIdentity identity() const;

  /// Replies "busy", those that could not be understood, and those of programs that were not asked.
  std::uint64_t busy() const;
  std::uint64_t unreadable() const;
  std::uint64_t unasked() const;

 private:
  struct Place {
    Batch* batch = nullptr;
    Request* request = nullptr;
    bus::Guid writer{};  // of the reply at hand
  };
  struct Replica {
    std::string name;
    bus::Guid writer{};
  };

  bool IsWanted(const conav_msgs::msg::PerceptionReply& message) const;
  void ReadLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  /// Logs which model answers, once and when it changes.
  void NoteModelLocked(const PerceptionReply& reply);
  void NoteBusyLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  void NoteOtherModelLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  void NoteUnreadableLocked(const Place& place, const std::string& reason);
  void NoteUnaskedLocked(const conav_msgs::msg::PerceptionReply& message);
  void RefuseLocked(const Place& place, const std::string& reason);
  void DeclineLocked(const Place& place);

  const Wanted wanted_;
  LogLimit unreadable_logged_;
  LogLimit other_models_logged_{std::chrono::seconds(10)};
  LogLimit busy_logged_{std::chrono::seconds(10)};
  LogLimit refusals_logged_{std::chrono::seconds(10)};
  LogLimit unasked_logged_{std::chrono::seconds(10)};
  mutable std::mutex mutex_;                         // guards all below, and the batches
  std::unordered_map<std::uint64_t, Place> places_;  // by request_id
  ModelIdentity answering_{"remote", "", ""};
  std::optional<Replica> replica_;
  std::uint64_t busy_ = 0;
  std::uint64_t unreadable_ = 0;
  std::uint64_t unasked_ = 0;
};

/// Asks the nhpm service over the bus; the first replica that replies answers.
///
/// A batch becomes one request (several when beliefs differ in shape or there are very many),
/// addressed to the replica that answered last, so that a request is computed once and no other
/// program decides what pictures are worth. One that is not answered is repeated after
/// `retry_interval`, one that a replica declines (OpenRequests) after `busy_pause`, both to all
/// replicas: a service answers a repeat alike, and the first good reply counts. Silence and replies
/// that are of no use are logged.
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
  /// Of the model that replied last; before any did, the name of the model wanted, or "remote".
  ModelIdentity identity() const override { return open_.identity(); }

  /// How often requests were sent again because no reply came in time.
  std::uint64_t repeats() const { return repeats_.load(); }
  /// Replies "busy".
  std::uint64_t busy() const { return open_.busy(); }
  /// Replies that could not be understood.
  std::uint64_t refused() const { return open_.unreadable(); }
  /// Replies of programs that were not asked.
  std::uint64_t unasked() const { return open_.unasked(); }

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
