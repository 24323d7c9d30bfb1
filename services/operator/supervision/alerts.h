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

/// How a robot that was heard of is, as far as it is worth an alert.
struct RobotCondition {
  std::string name;
  bool lost = false;    // nobody publishes it any more
  bool stands = false;  // its command was refused or expired
};

/// A process that says nothing on /diagnostics for longer is silent.
inline constexpr std::chrono::seconds kSilentAfter{5};

/// Whether it stands, by what asks for the operator.
bool Stands(const std::vector<AttentionItem>& items, const std::string& robot);

/// How a process is, as far as it is worth an alert.
struct ProcessCondition {
  std::string name;
  bool failed = false;
  bool silent = false;
  std::string message;
};

/// What is wrong now, of what the operator service sees: robots that stand for want of a command or
/// are not heard of any more, processes that are ill or silent, and its own disk. What robots ask is
/// no alert: that is the attention queue's. `storage_failure`: empty = the disk is well; nothing =
/// nothing was written yet.
Findings FindingsOf(const std::vector<RobotCondition>& robots,
                    const std::vector<ProcessCondition>& processes,
                    const std::optional<std::string>& storage_failure);

/// The alerts of a run: one for each matter, however often it comes and goes (ISA 18.2: no
/// chattering), until somebody has acknowledged it and it is over.
///
/// A matter that comes back while its alert is still there raises that one again: the count goes up,
/// and it has to be acknowledged again. One that was acknowledged and was seen to be over is history;
/// the next time is a new alert. Of history the newest kHistoryKept are kept.
/// Pure; threads: not synchronised. Times: wall time, s since 1970.
class AlertRegistry {
 public:
  static constexpr std::size_t kHistoryKept = 200;

  struct Changes {
    std::vector<Alert> changed;          // as they are now
    std::vector<std::uint64_t> dropped;  // history that is not kept any more
  };

  static bool IsHistory(const Alert& alert) {
    return !alert.active && !alert.acknowledged_by.empty();
  }

  /// What was stored. What was true then is true until Update() knows better.
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
  std::vector<std::uint64_t> DropHistory();

  std::map<std::uint64_t, Alert> alerts_;
  std::uint64_t last_id_ = 0;
};

}  // namespace conav::operators
