#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "operator/alerts/alert.h"

namespace conav::operators {

/// The alerts of a run: one for each matter, however often it comes and goes (ISA 18.2: no
/// chattering), until somebody has acknowledged it and it is over.
///
/// A matter that comes back while its alert is still there raises that one again: the count goes up,
/// and it has to be acknowledged again. One that was acknowledged and was seen to be over is history;
/// the next time is a new alert. Of history the newest kHistoryKept are kept.
/// Pure; threads: not synchronised. Times: wall time, s since 1970.
class AlertBook {
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
