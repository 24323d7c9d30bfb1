#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/supervision.h"
#include "operator/alerts/alert.h"

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

}  // namespace conav::operators
