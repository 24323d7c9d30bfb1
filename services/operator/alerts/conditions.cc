#include "operator/alerts/conditions.h"

#include <fmt/format.h>

namespace conav::operators {
namespace {

Condition OfItem(const AttentionItem& item) {
  if (item.reason == AttentionReason::kLinkLost) {
    return {"link/" + item.robot, Severity::kAlarm, item.robot,
            fmt::format("nothing is heard of {} any more", item.robot),
            "Look at its last known place. Is its simulator or radio alive?"};
  }
  return {"command/" + item.robot, Severity::kWarning, item.robot,
          fmt::format("{} stands: its command was refused or expired", item.robot),
          "Is its planner alive? Draw it another path, or stop it."};
}

Condition OfProcess(const ProcessCondition& process) {
  if (process.silent) {
    return {"silent/" + process.name, Severity::kWarning, process.name,
            fmt::format("{} is silent", process.name), "Is the process, or its host, alive?"};
  }
  return {"health/" + process.name, Severity::kWarning, process.name,
          fmt::format("{}: {}", process.name, process.message), "See its log."};
}

}  // namespace

std::vector<Condition> ConditionsOf(const std::vector<AttentionItem>& items,
                                    const std::vector<ProcessCondition>& processes,
                                    const std::string& storage_failure) {
  std::vector<Condition> conditions;
  for (const AttentionItem& item : items) {
    const bool stands =
        item.reason == AttentionReason::kLinkLost || item.reason == AttentionReason::kCommandFailed;
    if (stands) conditions.push_back(OfItem(item));
  }
  for (const ProcessCondition& process : processes) {
    if (process.silent || process.failed) conditions.push_back(OfProcess(process));
  }
  if (!storage_failure.empty()) {
    conditions.push_back({"storage", Severity::kAlarm, "operator",
                          "edits and paths cannot be stored: " + storage_failure,
                          "Make room on the disk; nothing that was accepted is lost."});
  }
  return conditions;
}

}  // namespace conav::operators
