#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "launcher/bus_place.h"
#include "launcher/demo_options.h"
#include "launcher/episode.h"
#include "launcher/metrics.h"
#include "launcher/outcome.h"
#include "launcher/planner_watch.h"
#include "launcher/process_group.h"
#include "launcher/progress.h"
#include "launcher/run_folder.h"

namespace conav::launcher {

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
  void TellWhoDrives();
  /// Once, when it can be opened.
  void TellConsole();
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
  void TellWhereRobotsStand();
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
  PlannerWatch planners_;
  Outcome outcome_;
  std::string console_;       // its URL, once it was told
  std::string died_service_;  // that ended the run; "sim" also among several worlds
  ProcessGroup processes_;
};

}  // namespace conav::launcher
