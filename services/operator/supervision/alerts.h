#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "operator/belief/alert.h"

namespace conav::operators {

/// What may raise an alert about a robot that has reported.
struct RobotCondition {
  std::string name;
  bool lost = false;               // its publisher is gone, or silent for kLostAfter
  bool stands = false;             // its command was refused or expired
  bool resumed_elsewhere = false;  // another program resumed it, which was stopped here
  bool stop_unconfirmed = false;   // it does not confirm that it was stopped
  std::string map_problem;         // why its map cannot be used, for people; empty = it can
  std::string goals_problem;       // what is wrong with its goals, for people; empty = nothing
};

/// A process without a report on /diagnostics for longer than this is silent: with the reports' and
/// the alerts' periods noticed within 2 s.
inline constexpr std::chrono::milliseconds kSilentAfter{1500};
/// A robot without a state for longer than this is lost: noticed within 3 s. States come at least
/// once a second.
inline constexpr std::chrono::milliseconds kLostAfter{2500};
/// So long after its restart a process is named.
inline constexpr std::chrono::seconds kRestartShown{30};

/// Whether the attention queue says that its command failed.
bool Stands(const std::vector<AttentionItem>& items, const std::string& robot);

/// What may raise an alert about a process.
struct ProcessCondition {
  std::string name;
  bool failed = false;
  bool silent = false;
  std::string message;
  bool restarted = false;  // within kRestartShown
  std::string kept;        // of a restarted one: what it still knows, for people; may be empty
};

/// A host's clock.
struct ClockCondition {
  std::string host;
  double ahead_s = 0.0;  // of this host's; negative = behind
  double error_s = 0.0;  // at most
};

/// Another system in the DDS domain. That it was met is the alert; nobody notices that it has gone.
struct SystemCondition {
  std::string name;
  bool just_met = false;
};

/// What is wrong now: robots whose command failed or whose link is lost, processes with an error or
/// silent, and the operator service's own disk. Questions of robots are items of the attention
/// queue instead. `storage_failure`: empty = the disk is well; nothing = nothing was written yet.
Findings FindingsOf(const std::vector<RobotCondition>& robots,
                    const std::vector<ProcessCondition>& processes,
                    const std::optional<std::string>& storage_failure,
                    const std::vector<SystemCondition>& other_systems = {},
                    const std::vector<ClockCondition>& clocks = {});

/// The alerts of a run: one for each condition, however often it comes and goes (ISA 18.2: no
/// chattering), until it is acknowledged and over.
///
/// A condition that returns while its alert is still there raises that one again: the count goes
/// up, and it has to be acknowledged again. One that was acknowledged and was seen to be over is
/// history; the next time is a new alert. Of history the newest kHistoryKept are kept. Pure;
/// threads: not synchronised. Times: wall time, s since 1970.
class AlertRegistry {
 public:
  static constexpr std::size_t kHistoryKept = 200;
  /// Of warnings that are not history; of more the oldest become history. Alarms stay.
  static constexpr std::size_t kWarningsKept = 200;

  struct Changes {
    std::vector<Alert> changed;          // as they are now
    std::vector<std::uint64_t> dropped;  // history that is no longer stored
  };

  static bool IsHistory(const Alert& alert) {
    return !alert.active && !alert.acknowledged_by.empty();
  }

  /// Restores what was stored; it counts until Update() knows better.
  void Restore(std::vector<Alert> alerts);

  /// What this changes.
  Changes Update(const Findings& findings, double now_s);

  /// What the alert will be; it counts once it is adopted. Errors: kNotFound.
  [[nodiscard]] Result<Alert> Acknowledge(std::uint64_t id, const std::string& client,
                                          double now_s) const;
  [[nodiscard]] Result<Alert> Shelve(std::uint64_t id, double duration_s, double now_s) const;
  void Adopt(const Alert& alert);

  const std::map<std::uint64_t, Alert>& alerts() const { return alerts_; }

 private:
  Alert* FindOpen(const std::string& key);
  void Raise(const Condition& condition, double now_s, Changes& changes);
  void CloseOldWarnings(double now_s, Changes& changes);
  std::vector<std::uint64_t> DropHistory();

  std::map<std::uint64_t, Alert> alerts_;
  std::uint64_t last_id_ = 0;
};

}  // namespace conav::operators
