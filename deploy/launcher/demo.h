#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/msg/planner_lease.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "launcher/bus_session.h"
#include "launcher/demo_options.h"
#include "launcher/demo_plan.h"
#include "launcher/process.h"
#include "launcher/progress.h"
#include "launcher/run_folder.h"
#include "launcher/run_log.h"

namespace conav::launcher {

/// Reports who drives which robots in a demo with several planners: "planner-1 drives r1, r3",
/// "planner-2 took over r1, r3 from planner-1".
class PlannerMonitor {
 public:
  /// `reports_first`: also reports the first planner of a robot.
  explicit PlannerMonitor(bool reports_first) : reports_first_(reports_first) {}

  /// Folds in an announcement; returns the line to print, or an empty text.
  std::string Fold(const PlannerLease& lease);

 private:
  struct Driver {
    std::uint64_t lease_epoch = 0;
    std::string node;
    std::string instance;
  };
  bool reports_first_;
  std::map<std::string, Driver> drivers_;  // by robot
};

/// Why a demo ended.
enum class EndReason { kAllGoalsReached, kProcessDied, kTimeLimit, kInterrupted };

struct Outcome {
  EndReason reason = EndReason::kAllGoalsReached;
  std::string detail;  // which process died and how; empty if none did
  double wall_s = 0.0;
  std::string dds;  // as given, or the default vendor
  int domain = 0;
  std::string run_folder;
  std::string weights_checksum;         // of the weights in use; empty without
  std::optional<double> mapping_value;  // of the search of ig-mcts
  std::map<std::string, int> restarts;  // by process; only those that were restarted
};

/// The content of metrics.json and --json: the run's facts, then the measures of ToJson(metrics).
nlohmann::ordered_json OutcomeJson(const DemoOptions& options, const Outcome& outcome,
                                   const EpisodeMetrics& metrics);

/// "ended: all goals reached", "ended: planner (pid 12) died: signal 9 (Killed)".
std::string OutcomeLine(const Outcome& outcome);

/// The result of a run.
struct DemoResult {
  Outcome outcome;
  EpisodeMetrics metrics;
  /// Why files of the run folder were not written, one line each; the result counts all the same.
  std::vector<std::string> unwritten;

  bool all_goals_reached() const {
    return outcome.reason == EndReason::kAllGoalsReached && metrics.all_goals_reached;
  }
};

/// "planner 2, sim 1": how often each process was restarted; empty if none was.
std::string RestartsLine(const Outcome& outcome);

/// One run of the whole system, for `conav demo` and `conav study`: starts the services, restarts
/// those that die (RestartPolicy), follows them on the bus, ends them. Writes metrics.json and
/// then episode.svg into the run folder.
/// Threads: one; several demos may run on a thread each, every one in a domain of its own.
class Demo {
 public:
  /// Joins the bus and creates the run folder; starts nothing yet. `program_folder` contains
  /// conav-sim and the other programs; `options`, `clock` and `progress` outlive the demo. `kept`
  /// is a domain that an earlier demo of the caller found free; without it, looks for one. Throws
  /// UsageError when another conav uses the domain, StartupError when the bus or the run folder is
  /// not available.
  Demo(const DemoOptions& options, std::filesystem::path program_folder, const Clock& clock,
       Progress& progress, std::optional<DomainLease> kept = std::nullopt);

  /// Called often, with the processes that run.
  using OnTurn = std::function<void(const std::vector<const Process*>& running)>;

  /// Blocks until the run and all its processes have ended. Throws StartupError when a process
  /// cannot be started or the run folder cannot be written.
  DemoResult Run(const StopToken& stop, const OnTurn& on_turn = nullptr);

  /// So far.
  const Outcome& outcome() const { return outcome_; }

  /// Hands over the domain to the next demo; call after Run().
  DomainLease TakeLease() { return std::move(session_.lease); }

 private:
  /// A process of the run over all its restarts.
  struct Service {
    PlannedProcess planned;
    RestartPolicy policy;
    Clock::TimePoint started{};
    std::optional<Clock::TimePoint> restart_at;  // while it is dead
  };

  void StartProcesses();
  const Process& Start(Service& service);
  /// Gives an operator service that starts again its ports of before, so that open pages find it.
  void KeepPorts();
  void Follow(const StopToken& stop, const OnTurn& on_turn);
  /// Restarts what died, each after its delay; returns why that ends the run, or an empty text.
  std::string KeepAlive();
  void RestartDue();
  void ReportDrivers();
  /// Reports the console's URL once the page can be opened.
  void ReportConsole();
  /// All goals are reached: keeps the console open until the user stops.
  void StayOpen(const StopToken& stop);
  /// Stops the processes that `meant` selects; reports those it had to kill.
  void Stop(const std::function<bool(const Process&)>& meant);
  /// Stops all processes, the recorder last, so that it captures the exits of the others.
  void StopAll();
  /// Receives until the bus is quiet and, after a death, until the robots stand.
  void TakeLastSamples();
  void ReportPositions();
  DemoResult Finish();
  double ElapsedSeconds() const;

  const DemoOptions& options_;
  std::filesystem::path program_folder_;
  const Clock& clock_;
  Clock::TimePoint start_;
  Episode episode_;
  BusSession session_;
  RunFolder run_;
  Progress& progress_;
  PlannerMonitor planners_;
  Outcome outcome_;
  std::string console_;   // its URL, once reported
  std::string foxglove_;  // the same
  // the service whose death ended the run; "sim" also among several worlds
  std::string died_service_;
  std::vector<Service> services_;
  ProcessGroup processes_;
};

}  // namespace conav::launcher
