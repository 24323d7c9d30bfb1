#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/msg/planner_lease.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "launcher/bus_place.h"
#include "launcher/demo_options.h"
#include "launcher/process.h"
#include "launcher/progress.h"
#include "launcher/run_folder.h"
#include "launcher/run_log.h"

namespace conav::launcher {

/// Who drives which robots, in lines for the person who watches a demo with several planners:
/// "planner-1 drives r1, r3", "planner-2 took over r1, r3 from planner-1".
class PlannerMonitor {
 public:
  /// `tells_first`: also who is the first to drive a robot.
  explicit PlannerMonitor(bool tells_first) : tells_first_(tells_first) {}

  /// Folds in an announcement; the line that it is worth, empty for none.
  std::string Fold(const PlannerLease& lease);

 private:
  struct Driver {
    std::uint64_t lease_epoch = 0;
    std::string node;
    std::string instance;
  };
  bool tells_first_;
  std::map<std::string, Driver> drivers_;  // by robot
};

/// Why a demo ended.
enum class EndReason { kAllGoalsReached, kProcessDied, kTimeLimit, kInterrupted };

struct Outcome {
  EndReason reason = EndReason::kAllGoalsReached;
  std::string detail;  // which process died and how; empty when all went well
  double wall_s = 0.0;
  std::string dds;  // as asked for, or the default vendor
  int domain = 0;
  std::string run_folder;
  std::string weights_checksum;  // of the weights that shall answer; empty without
};

/// What metrics.json and --json hold: the run's facts, then the measures of ToJson(metrics).
nlohmann::ordered_json OutcomeJson(const DemoOptions& options, const Outcome& outcome,
                                   const EpisodeMetrics& metrics);

/// "ended: all goals reached", "ended: planner (pid 12) died: signal 9 (Killed)".
std::string OutcomeLine(const Outcome& outcome);

/// What came of a run.
struct DemoResult {
  Outcome outcome;
  EpisodeMetrics metrics;

  bool all_goals_reached() const {
    return outcome.reason == EndReason::kAllGoalsReached && metrics.all_goals_reached;
  }
};

/// One run of the whole system, as `conav demo` shows it and `conav study` repeats it: starts the
/// services, follows them on the bus, ends them. The run folder holds metrics.json and episode.svg
/// afterwards.
/// Threads: one; several demos may run on a thread each, every one in a domain of its own.
class Demo {
 public:
  /// Joins the bus and makes the run folder; starts nothing yet. `program_folder` holds conav-sim
  /// and the others; `options`, `clock` and `progress` outlive the demo. `kept` is a domain that the
  /// caller has held since an earlier demo found it free; without it one is looked for. Throws
  /// UsageError when the domain is taken by another conav, StartupError when the bus or the run
  /// folder cannot be had.
  Demo(const DemoOptions& options, std::filesystem::path program_folder, const Clock& clock,
       Progress& progress, std::optional<DomainLease> kept = std::nullopt);

  /// Blocks until the run has ended and all its processes are gone. Throws StartupError when a
  /// process cannot be started or the run folder cannot be written.
  DemoResult Run(const StopToken& stop);

  /// After Run(): the domain, for the next demo.
  DomainLease TakeLease() { return std::move(place_.lease); }

 private:
  void StartProcesses();
  void Follow(const StopToken& stop);
  /// Sets outcome_ when one died that the run cannot do without.
  bool SomethingDied();
  /// Processes of that service that run.
  int CountRunning(const std::string& service) const;
  /// Whether the run goes on without a process that died as `what` tells; says so.
  bool CanDoWithout(const Process& process, const std::string& what);
  void ReportDrivers();
  /// Once, when it can be opened.
  void ReportConsole();
  /// All goals are reached: whoever looks at the console may go on looking.
  void StayOpen(const StopToken& stop);
  /// Says who had to be killed.
  void Stop(const std::function<bool(const Process&)>& meant);
  /// So that nobody commands the robots any more.
  void StopPlanners();
  /// The recorder last, so that it hears all others.
  void StopAll();
  /// Listens until it is quiet and, after a death, until the robots stand.
  void TakeLastNews();
  void ReportPositions();
  DemoResult Finish();
  double ElapsedSeconds() const;

  const DemoOptions& options_;
  std::filesystem::path program_folder_;
  const Clock& clock_;
  Clock::TimePoint start_;
  Episode episode_;
  BusPlace place_;
  RunFolder run_;
  Progress& progress_;
  PlannerMonitor planners_;
  Outcome outcome_;
  std::string console_;       // its URL, once it was told
  std::string died_service_;  // that ended the run; "sim" also among several worlds
  ProcessGroup processes_;
};

}  // namespace conav::launcher
