#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/protocol/planning.h"
#include "common/runtime/log_limit.h"
#include "common/runtime/result.h"
#include "conav_planning.h"

namespace conav::planner {

/// Requests that wait for replies, and what the replies tell of who answers.
///
/// The first good reply to a request counts. A replica that is busy, refuses, serves another model
/// than the one wanted, or cannot be understood has declined: its reason is kept and logged, and
/// the request stays open for the others.
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
    std::optional<std::vector<PerceptionAnswer>> answers;
    std::set<std::string> refused_by;  // replicas that will not answer a repeat either
    std::string refusal;               // why the last of them will not
    std::string busy;                  // what the last busy replica said
  };

  /// The requests of one thread, open as long as this object lives.
  class Batch {
   public:
    /// `owner` outlives it. The messages' request_id are unique.
    Batch(OpenRequests& owner, std::vector<conav_msgs::msg::PerceptionRequest> messages);
    ~Batch();
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;

    /// To be sent, also again; they stay where they are.
    std::vector<conav_msgs::msg::PerceptionRequest*> Unanswered();
    enum class Outcome { kAnswered, kDeclined, kSilence };
    /// Waits until all are answered or `silence_end`; once somebody declined, until `pause` later,
    /// unless all `replicas` refused.
    Outcome Wait(TimePoint silence_end, std::chrono::nanoseconds pause, std::size_t replicas);
    /// Whether one is open that as many as `replicas` refused.
    bool IsRefusedByAll(std::size_t replicas);
    /// Why there is no answer, as far as somebody said it: kUnavailable.
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
  void Receive(const conav_msgs::msg::PerceptionReply& message);

  /// Who gave the last good reply; empty when nobody did, or that replica declined since.
  std::string replica() const;
  /// Empties replica(), and says who it was.
  std::string ForgetReplica();
  /// The model wanted, or the one that gave the last good reply, or "remote".
  std::string model() const;
  /// Name and checksum of the model that gave the last good reply.
  std::string identity() const;

  /// Replies "busy", and those that could not be understood.
  std::uint64_t busy() const;
  std::uint64_t unreadable() const;

 private:
  struct Place {
    Batch* batch = nullptr;
    Request* request = nullptr;
  };

  bool IsWanted(const conav_msgs::msg::PerceptionReply& message) const;
  void ReadLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  /// Logs which model answers, once and when it changes.
  void NoteModelLocked(const PerceptionReply& reply);
  void NoteBusyLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  void NoteOtherModelLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message);
  void NoteUnreadableLocked(const Place& place, const conav_msgs::msg::PerceptionReply& message,
                            const std::string& reason);
  void RefuseLocked(const Place& place, const std::string& replica, const std::string& reason);
  void DeclineLocked(const Place& place, const std::string& replica);

  const Wanted wanted_;
  LogLimit unreadable_logged_;
  LogLimit other_models_logged_{std::chrono::seconds(10)};
  LogLimit busy_logged_{std::chrono::seconds(10)};
  LogLimit refusals_logged_{std::chrono::seconds(10)};
  mutable std::mutex mutex_;                         // guards all below, and the batches
  std::unordered_map<std::uint64_t, Place> places_;  // by request_id
  std::string answering_model_ = "remote";
  std::string answering_checksum_;
  std::string replica_;
  std::uint64_t busy_ = 0;
  std::uint64_t unreadable_ = 0;
};

}  // namespace conav::planner
