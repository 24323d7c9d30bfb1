#pragma once

#include <string>
#include <vector>

#include "common/protocol/supervision.h"
#include "operator/alerts/alert.h"

namespace conav::operators {

/// How a process is, as far as it is worth an alert.
struct ProcessCondition {
  std::string name;
  bool failed = false;
  bool silent = false;
  std::string message;
};

/// What is wrong now, of what the operator service sees: robots that stand for want of a command or
/// are not heard of, processes that are ill or silent, and its own disk. What robots ask is no alert:
/// that is the attention queue's.
std::vector<Condition> ConditionsOf(const std::vector<AttentionItem>& items,
                                    const std::vector<ProcessCondition>& processes,
                                    const std::string& storage_failure);

}  // namespace conav::operators
