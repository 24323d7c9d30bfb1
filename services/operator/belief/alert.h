#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace conav::operators {

/// Alarms need action by a person at once.
enum class Severity : std::uint8_t { kNotice, kWarning, kAlarm };

/// Something that is wrong now.
struct Condition {
  std::string key;  // the same for the same condition
  Severity severity = Severity::kWarning;
  std::string source;  // robot, world or service
  std::string text;
  std::string advice;  // what the operator can do
  bool operator==(const Condition&) const = default;
};

/// Conditions that are true now, and the keys of those that are not. A condition in neither list is
/// unknown, as for a robot that has not reported yet.
struct Findings {
  std::vector<Condition> wrong;
  std::vector<std::string> fine;
};

/// A condition that was or is true, and what people did about it. Times: wall time, s since 1970.
struct Alert {
  std::uint64_t id = 0;
  Condition condition;
  double raised_s = 0.0;
  double newest_s = 0.0;    // when it became true last
  std::uint32_t count = 1;  // how often it became true
  bool active = true;       // as last known
  std::string acknowledged_by;
  double acknowledged_s = 0.0;
  double shelved_until_s = 0.0;
  bool operator==(const Alert&) const = default;
};

}  // namespace conav::operators
