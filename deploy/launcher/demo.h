#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "launcher/bus_place.h"
#include "launcher/demo_options.h"
#include "launcher/episode.h"
#include "launcher/outcome.h"
#include "launcher/process_group.h"
#include "launcher/progress.h"
#include "launcher/run_folder.h"

namespace conav::launcher {

/// One run of `conav demo`: starts the services, follows them on the bus, ends them.
class Demo {
 public:
  /// Joins the bus and makes the run folder; starts nothing yet. `program_folder` holds conav-sim
  /// and the others. Throws UsageError when the domain is taken by another conav, StartupError when
  /// the bus or the run folder cannot be had.
  Demo(const DemoOptions& options, std::filesystem::path program_folder, const Clock& clock);

  /// Blocks until the run has ended and all its processes are gone; writes metrics.json and
  /// episode.svg, prints the table. True when all goals were reached.
  bool Run(const StopToken& stop);

 private:
  void StartProcesses();
  void Follow(const StopToken& stop);
  /// Sets outcome_ when one died that the run cannot do without.
  bool SomethingDied();
  int ReplicasLeft() const;
  /// So that nobody commands the robots any more.
  void StopPlanner();
  /// Listens until it is quiet and, after a death, until the robots stand.
  void TakeLastNews();
  void TellWhereRobotsStand();
  void Finish();
  double ElapsedSeconds() const;

  const DemoOptions& options_;
  std::filesystem::path program_folder_;
  const Clock& clock_;
  Clock::TimePoint start_;
  Episode episode_;
  BusPlace place_;
  RunFolder run_;
  Progress progress_;
  Outcome outcome_;
  std::string died_service_;  // that ended the run; "sim" also among several worlds
  ProcessGroup processes_;
};

}  // namespace conav::launcher
