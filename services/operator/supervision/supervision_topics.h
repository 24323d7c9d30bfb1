#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/clock_offset.h"
#include "common/runtime/log.h"
#include "common/service/diagnostics.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/supervision/alerts.h"
#include "operator/supervision/attention_queue.h"
#include "operator/supervision/control.h"
#include "operator/supervision/workload.h"

namespace conav::operators {

/// The operator service's attention queue on the bus: keeps it, measures the operator's work on it,
/// publishes both.
///
/// Publishes an empty queue at once; then the queue whenever an item has come, gone or moved, and
/// at least each second (wall time) for the measures. Selections are not stored: they change
/// nothing that has to outlive the service.
/// Threads: one, the service's.
class AttentionTopics {
 public:
  /// `participant` and `clock` outlive it.
  AttentionTopics(bus::Participant& participant, const AttentionOptions& options,
                  const Clock& clock);

  /// `now` is the operator's time throughout: the newest simulation time of all worlds.
  void Receive(const AttentionRequest& request, SimTime now) { queue_.Receive(request, now); }
  void Receive(const RobotState& state, SimTime now) { queue_.Receive(state, now); }
  /// Found in the database or withdrawn by the service itself.
  void Receive(const Guidance& guidance, SimTime now) { queue_.Receive(guidance, now); }
  void LoseLink(const std::string& robot, SimTime now) { queue_.LoseLink(robot, now); }
  void LosePlanner(const std::string& robot, SimTime now) { queue_.LosePlanner(robot, now); }
  /// A request of `client` was accepted, as of WorkloadMeter.
  void Accepted(const std::string& client, const std::string& robot_or_world, SimTime now);
  /// `request` holds a SelectRequest. A repeat gets the reply of the first time, unless many other
  /// clients selected something meanwhile.
  OperatorReply Select(const OperatorRequest& request, SimTime now);

  /// After everything that one step brought.
  void Step(SimTime now);

  /// As it was published last.
  const AttentionQueueState& published() const { return published_; }
  const std::vector<AttentionItem>& items() const { return queue_.items(); }

 private:
  /// Passes new questions to the meter, before what becomes of them.
  void TakeArrivals(SimTime now);
  void Publish(SimTime now);

  AttentionOptions options_;
  const Clock& clock_;
  AttentionQueue queue_;
  WorkloadMeter meter_;
  std::deque<OperatorReply> newest_selections_;  // one for each client, newest last
  bus::Publisher<conav_msgs::msg::AttentionQueue> publisher_;
  AttentionQueueState published_;
  Clock::TimePoint published_at_{};
};

class ServiceMonitor;

/// The requests of clients over DDS, each client under a name of its own (ClientNames).
/// Threads: one, the service's.
class RequestTopics {
 public:
  /// Both outlive it.
  RequestTopics(bus::Participant& participant, const Clock& clock)
      : clock_(clock), requests_(participant, bus::kOperatorRequest) {}

  /// Since the last call. Left out, with a warning: those under another program's name, which a reply would
  /// reach, and those that come too late: by the clock of their process where `processes` knows it,
  /// else by RequestDelays.
  std::vector<OperatorRequest> Take(const ServiceMonitor& processes);
  /// `client` asks within this process.
  void ClaimOwn(const std::string& client) { names_.ClaimOwn(client, clock_.Now()); }

 private:
  const Clock& clock_;
  ClientNames names_;
  RequestDelays delays_;
  LogLimit refusals_logged_;
  bus::Subscriber<conav_msgs::msg::OperatorRequest> requests_;
};

/// Control and stops of robots (ControlRegistry): on disk first, then on the bus. A stop takes effect
/// although the disk fails, and is stored when it works again. After a restart stopped robots stay
/// stopped; nobody has control.
///
/// Publishes a robot's newest stop order at once, when there is one.
/// Threads: one, the service's.
class ControlTopics {
 public:
  /// All outlive it.
  ControlTopics(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
                const Clock& clock);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now`: the operator's time.
  BeliefStore::Answer Answer(const OperatorRequest& request, SimTime now);
  /// Why another client's control forbids `request`; empty = it does not.
  std::string CheckAllowed(const OperatorRequest& request) const;
  /// A request of `client` was not refused because of another client's control.
  void Renew(const std::string& client) { registry_.Renew(client, clock_.Now()); }
  void Leave(const std::string& client) { registry_.ReleaseAll(client, clock_.Now()); }
  /// Stops a robot again that another program has resumed.
  void Receive(const RobotState& state);
  /// Whether another program resumed `robot`, which was stopped here: from then until the robot has
  /// confirmed that it is stopped again, and at least once.
  bool TakeResumedElsewhere(const std::string& robot);
  /// Whether `robot` was stopped 2 s ago and its own state has not said so since.
  bool IsStopUnconfirmed(const std::string& robot) const;
  void Step();

  const ControlRegistry& registry() const { return registry_; }

 private:
  static constexpr std::chrono::seconds kSavePeriod{1};
  using StopPublisher = bus::Publisher<conav_msgs::msg::StopOrder>;

  Result<std::vector<StopOrder>> Decide(const OperatorRequest& request, SimTime now,
                                        ControlRegistry& registry) const;
  void Publish(const StopOrder& order);

  BeliefStore& store_;
  const Clock& clock_;
  ControlRegistry registry_;
  std::map<std::string, std::unique_ptr<StopPublisher>> stops_;  // by robot
  std::set<std::string> resumed_elsewhere_;
  Clock::TimePoint save_due_at_{};
  /// Robots that have yet to confirm a stop: since when. A robot that reports for the first time has
  /// just received the order.
  struct Unconfirmed {
    Clock::TimePoint since;
    bool has_reported;
  };
  std::map<std::string, Unconfirmed> unconfirmed_;
};

/// The newest report of a process on /diagnostics.
struct ServiceStatus {
  std::string name;
  Health::Level level = Health::Level::kOk;
  std::string message;
  Clock::TimePoint received_at{};
  bool silent = false;                           // for longer than kSilentAfter
  std::string started;                           // ReportedHealth::started
  std::optional<Clock::TimePoint> restarted_at;  // the newest restart that was seen
  bus::Guid writer{};                            // of its newest report
  std::string host;                              // that answered a clock probe
  ClockOffset clock;                             // its time of day, against our monotonic time
};

/// Listens to the health of conav's processes; those of others on /diagnostics are left out. Of more
/// than kMostProcesses names the later ones are left out, too, and an entry "diagnostics" says so.
///
/// Measures each process's clock against ours with a probe each kProbePeriod, since the times that
/// messages carry are those of their publishers' clocks. Until a process has answered, and for one that
/// does not, its clock counts as ours.
/// Threads: one.
class ServiceMonitor {
 public:
  static constexpr std::size_t kMostProcesses = 128;
  static constexpr std::chrono::seconds kProbePeriod{2};

  ServiceMonitor(bus::Participant& participant, const Clock& clock)
      : own_name_(participant.node_name()),
        clock_(clock),
        diagnostics_(participant, bus::kDiagnostics),
        probes_(participant, bus::kClockProbe) {}

  void Step();
  /// For how long a message of `writer`, which it stamped with `source`, was under way, s; nothing
  /// while the difference of the clocks is not known.
  std::optional<double> DelayOf(bus::SourceTime source, const bus::Guid& writer) const;
  /// When `writer` published a message that it stamped with `source`, by our clock: wall time, s since 1970,
  /// not in the future.
  double PublishedAt(bus::SourceTime source, const bus::Guid& writer) const;
  /// By host: how far its clock is ahead of ours, s; of several processes the one that is off most for certain.
  std::map<std::string, ClockOffset::Sample> ClocksOfHosts() const;
  /// By name.
  const std::map<std::string, ServiceStatus>& services() const { return services_; }
  std::vector<ProcessCondition> Conditions() const;
  /// What `service` says, and how far its host's clock is off where that is too far.
  std::string MessageOf(const ServiceStatus& service) const;
  /// How far the clock of each host is ahead.
  void AddTo(Health& health) const;

 private:
  void Take(const ReportedHealth& health, const bus::Guid& writer, Clock::TimePoint now);

  const std::string own_name_;
  const Clock& clock_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  bus::Publisher<rosgraph_msgs::msg::Clock> probes_;
  std::deque<std::chrono::nanoseconds> asked_;  // the newest probes
  Clock::TimePoint probe_due_at_{};
  std::optional<Clock::TimePoint> crowded_at_;
  std::map<std::string, ServiceStatus> services_;
};

/// The alerts of the operator service: on disk before they are shown, also over restarts, of which
/// its own is one.
/// Threads: one, the service's.
class AlertTopics {
 public:
  /// Both outlive it. Takes the events of `participant`: whether there are other systems.
  AlertTopics(BeliefStore& store, bus::Participant& participant);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now_s`: wall time.
  BeliefStore::Answer Answer(const OperatorRequest& request, double now_s);
  /// Raises and ends alerts.
  void Update(const std::vector<RobotCondition>& robots, const ServiceMonitor& services,
              const std::optional<std::string>& storage_failure, double now_s);
  /// Alerts that changed since the last call; all of them the first time.
  std::vector<Alert> TakeChanges();

 private:
  BeliefStore& store_;
  bus::Participant& participant_;
  std::vector<SystemCondition> other_systems_;
  std::string
      kept_;  // what this service knows from before its restart; empty = it is a first start
  std::optional<double> started_s_;
  AlertRegistry registry_;
  std::vector<Alert> changes_;
};

/// Counts decided requests and writes them to the process's log, refusals at most once a second.
///
/// A refusal that is not stored is decided again when its request is repeated; the newest of them
/// are remembered here, so that each is logged once.
/// Threads: one, the service's.
class RequestLog {
 public:
  static constexpr std::size_t kRefusalsRemembered = 256;

  /// `now`: simulation time of the request's world. True when the operator's command log is to have
  /// it: it was decided for the first time, and is neither a low-level action nor without effect.
  bool Note(const OperatorRequest& request, const BeliefStore::Answer& answer, SimTime now);

  /// Repeats are not counted again.
  std::uint64_t accepted() const { return accepted_; }
  std::uint64_t refused() const { return refused_; }

 private:
  /// False for one that is remembered.
  bool RememberRefusal(const OperatorRequest& request);

  std::uint64_t accepted_ = 0;
  std::uint64_t refused_ = 0;
  std::deque<std::pair<std::string, std::uint64_t>> refusals_;  // client and id, oldest first
  LogLimit refusals_logged_;
};

}  // namespace conav::operators
