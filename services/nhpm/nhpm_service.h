#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/msg/perception_model.h"
#include "common/msg/planning.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "nhpm/config.h"

namespace conav::nhpm {

/// The models of a service: one for everybody, and those of persons with one of their own. Follows
/// changes of their files, and logs each change and each bad file.
///
/// A caller keeps the model it holds: a reload only changes later results of For().
/// Threads: safe to call concurrently; Refresh() from one thread only.
class ServedModels {
 public:
  /// Throws StartupError when the model for everybody cannot be loaded or the folder of persons
  /// does not exist. Logs a person's bad file.
  explicit ServedModels(const NhpmConfig& config);

  /// Reloads changed files. If a file, or the whole folder of persons, cannot be read, the loaded
  /// model stays. A person whose file is gone gets the model for everybody.
  void Refresh();

  /// The model of that person; the one for everybody if the name is empty or unknown.
  std::shared_ptr<PerceptionModel> For(const std::string& person) const;
  std::size_t persons() const;

 private:
  /// Two files of one size may be written within one tick of the file system's clock; then the
  /// inode differs, because WriteWeightsFile renames.
  struct Stamp {
    std::int64_t time_ns = 0;
    std::uint64_t size = 0;
    std::uint64_t inode = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Source {
    PerceptionModelKind model;
    std::filesystem::path file;
    bool tried = false;
    std::optional<Stamp> seen;  // of the last attempt
    std::shared_ptr<PerceptionModel> loaded;
  };

  static std::optional<Stamp> StampOf(const std::filesystem::path& file);
  Result<void> Load(Source& source);
  void RefreshOne(const std::string& person, Source& source);
  void RefreshPersons();
  void Publish();

  const GlpfParameters glpf_;
  const std::filesystem::path person_folder_;
  Source everybody_;
  std::map<std::string, Source> persons_;
  std::error_code folder_error_;  // of the last check
  mutable std::mutex mutex_;      // guards all below
  std::shared_ptr<PerceptionModel> model_;
  std::map<std::string, std::shared_ptr<PerceptionModel>> model_of_person_;
};

/// A request from the bus without an answer yet.
struct OpenRequest {
  PerceptionRequest request;
  Clock::TimePoint arrived;

  /// When its client gives up; empty if the client does not say.
  std::optional<Clock::TimePoint> deadline() const;
  /// Cells of all queries together: the cost of an answer grows with them.
  std::size_t cells() const;
};

/// A bounded queue of the requests that wait for a computing thread, oldest first. A request beyond
/// the bound, or one that would be answered too late, gets its rejection at once.
///
/// The queue estimates the duration of an answer from the time per cell of earlier ones. While it
/// is empty it accepts every request: otherwise one slow answer could block all the faster ones
/// that would correct the estimate.
/// Threads: safe to call concurrently.
class RequestQueue {
 public:
  enum class Admission {
    kQueued,
    kRepeat,   // already open; it gets one answer
    kFull,     // `max_open` requests are open
    kTooSlow,  // the answer would come after its deadline
  };

  RequestQueue(std::size_t max_open, int threads) : max_open_(max_open), threads_(threads) {}

  /// Moves from `offered` only if it queues it. A repeat can extend the deadline of the open one.
  Admission Offer(OpenRequest&& offered);

  /// The oldest request, if any. It stays open until Finish().
  std::optional<OpenRequest> Take();
  /// Blocks until there is a request; empty once the queue is closed and empty.
  std::optional<OpenRequest> WaitAndTake();
  /// `computing` is the computing time; empty if nothing was computed.
  void Finish(const OpenRequest& taken, std::optional<std::chrono::nanoseconds> computing);
  /// Ends WaitAndTake() on all threads once the queue is empty.
  void Close();

  /// Requests that are waiting or being computed.
  std::size_t open() const;
  /// Expected time to answer a request of `cells` that arrives now: the threads share the open
  /// requests, one thread computes its own cells.
  std::chrono::nanoseconds ExpectedWait(std::size_t cells) const;

 private:
  std::optional<OpenRequest> TakeLocked();
  std::chrono::nanoseconds ExpectedWaitLocked(std::size_t cells) const;

  const std::size_t max_open_;
  const int threads_;
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::deque<OpenRequest> waiting_;
  std::vector<std::pair<std::string, std::uint64_t>> computing_;  // client and number
  std::size_t open_cells_ = 0;
  double seconds_per_cell_ = 0.0;  // moving average
  bool closed_ = false;
};

/// Answers perception requests of any number of planners, starting them in order of arrival.
///
/// Before the first request it publishes nothing but its health. Every request that names its
/// sender gets one reply: the answers, a refusal with its reason (malformed, another model
/// requested, a grid that the model does not support), or "busy" at once if the answer would be
/// late or too many are open. If a request's deadline passes while it waits, it gets "busy" without
/// any computation. Answers depend only on the request and the model that the reply names, so a
/// repeated request gets a repeated reply, and replicas agree. Ignores requests for another
/// replica. Reloads changed weights (ServedModels).
/// Threads: Run() receives on its own thread and computes on `config.threads` others.
class NhpmService {
 public:
  struct Counts {
    std::uint64_t requests = 0;  // answered
    std::uint64_t queries = 0;   // in these
    std::uint64_t refused = 0;   // rejected, with the reason in the reply
    std::uint64_t busy = 0;      // answered "busy"
    std::uint64_t late = 0;      // of these, because the deadline passed in the queue
    std::uint64_t dropped = 0;   // without a sender to reply to
    std::chrono::nanoseconds computing{0};
  };

  /// Throws StartupError (ServedModels).
  NhpmService(bus::Participant& participant, const NhpmConfig& config, const Clock& clock);

  /// Runs until `stop`; answers all open requests before it returns.
  void Run(const StopToken& stop);

  /// The two halves of Run() on the calling thread, for tests: waits up to `timeout` and takes the
  /// messages; answers all waiting requests.
  void Receive(std::chrono::nanoseconds timeout);
  void AnswerOpen();

  Counts counts() const;

 private:
  void Admit(const conav_msgs::msg::PerceptionRequest& message);
  void Answer(const OpenRequest& open);
  PerceptionReply ReplyTo(const PerceptionRequest& request) const;
  PerceptionReply Blank(const PerceptionRequest& request, const ModelIdentity& identity) const;
  void Send(const PerceptionReply& reply);
  void Count(const PerceptionReply& reply);
  void Drop(const std::string& reason);
  void SendWithout(const PerceptionRequest& request, PerceptionStatus status, std::string reason);
  void RefreshModels();
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  const int threads_;
  ServedModels models_;
  Clock::TimePoint next_refresh_;
  RequestQueue queue_;
  mutable std::mutex mutex_;  // guards counts_
  Counts counts_;
  Diagnostics diagnostics_;
  bus::Publisher<conav_msgs::msg::PerceptionReply> replies_;
  bus::Publisher<conav_msgs::msg::PerceptionReply> predictions_;
  bus::Subscriber<conav_msgs::msg::PerceptionRequest> requests_;
};

}  // namespace conav::nhpm
