#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/msg/planner_lease.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"

// One user: soak; pure, and tested without the bus.

namespace conav::launcher {

/// An edit that the operator service has accepted.
struct AcceptedEdit {
  std::string client;
  std::uint64_t request_id = 0;
  std::string world;
  EditRequest edit;
  std::uint64_t revision = 0;
  std::uint64_t known_revision = 0;  // accepted for this world before the edit was sent
};

/// What holds in every run, whatever dies: of messages as they come, of which some may be missed.
///
/// - Edits are linearizable: each accepted one gets the revision after the one that it was based on,
///   above all that were acknowledged before it was sent, and no two get the same; the published map
///   of that revision contains it, and revisions never go back. CheckJournal() compares the rest.
/// - A robot has at most one lease holder: the commands of a lease epoch come from one process, none
///   but the one with the highest epoch (of equal ones the highest instance) holds it for longer than
///   kLeaseLag, and the epoch that it shows never goes back.
/// - No command is carried out after its expiry, but for the control step in which it expires.
/// - A robot that was stopped does not move, and stays stopped until it is resumed.
/// Threads: one caller.
class Invariants {
 public:
  static constexpr std::chrono::seconds kLeaseLag{5};
  static constexpr std::size_t kMostTexts = 50;

  void See(const PlannerLease& lease, Clock::TimePoint now);
  /// `writer`: the process that sent it, by any name.
  void See(const RobotCommand& command, const std::string& writer);
  void See(const RobotState& state);
  void See(const Belief& belief);
  void See(AcceptedEdit edit);
  /// From now on the robot may not move, until Release().
  void Hold(const std::string& robot) { robots_[robot].held = true; }
  void Release(const std::string& robot) { robots_[robot].held = false; }
  void Violated(std::string text);

  static bool Stands(const RobotState& state);

  const std::vector<AcceptedEdit>& edits() const { return edits_; }
  /// The newest acknowledged revision of a world; 0 = none.
  std::uint64_t revision(const std::string& world) const;
  std::uint64_t count() const { return count_; }
  /// The first kMostTexts different ones.
  const std::vector<std::string>& violations() const { return violations_; }

 private:
  struct Holder {
    std::uint64_t lease_epoch = 0;
    std::string instance;
    Clock::TimePoint since{};
  };
  struct Robot {
    Holder holder;
    std::optional<RobotState> state;
    bool held = false;
    std::map<std::pair<std::uint64_t, std::uint64_t>, SimTime> expiry;  // by epoch and number
    std::map<std::uint64_t, std::string> writers;                       // of commands, by epoch
  };

  std::map<std::string, Robot> robots_;
  std::map<std::string, std::map<std::uint64_t, std::size_t>> edit_of_;  // by world and revision
  std::map<std::string, std::uint64_t> published_;                       // by world: revision
  std::vector<AcceptedEdit> edits_;
  std::uint64_t count_ = 0;
  std::vector<std::string> violations_;
};

/// Compares the closed database of an operator service with the edits that it acknowledged: each is
/// there with its revision; the revisions of a world's edits have no gap and no repeat; and all of
/// them, applied to the initial map, give the stored one. Worlds whose first edits are no longer kept
/// are not replayed.
void CheckJournal(const std::filesystem::path& database, Invariants& invariants);

/// What a process used at a moment of the run.
struct ProcessSample {
  std::string process;
  pid_t pid = 0;
  double at_s = 0.0;
  double rss_mb = 0.0;  // resident memory
  int fds = 0;
  int threads = 0;
};

/// Reads /proc. Nothing when there is no such process.
std::optional<ProcessSample> SampleProcess(std::string process, pid_t pid, double at_s);

/// MB per hour by least squares over the samples of one process; each life (pid) has a level of its
/// own, so what a restart frees counts as nothing. Nothing where no time passes.
std::optional<double> RssSlope(std::span<const ProcessSample> samples);

}  // namespace conav::launcher
