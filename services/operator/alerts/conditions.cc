#include "operator/alerts/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace conav::operators {
namespace {

Condition LostLink(const std::string& robot) {
  return {"link/" + robot, Severity::kAlarm, robot,
          fmt::format("nothing is heard of {} any more", robot),
          "Look at its last known place. Is its simulator or radio alive?"};
}

Condition FailedCommand(const std::string& robot) {
  return {"command/" + robot, Severity::kWarning, robot,
          fmt::format("{} stands: its command was refused or expired", robot),
          "Is its planner alive? Draw it another path, or stop it."};
}

Condition Silence(const ProcessCondition& process) {
  return {"silent/" + process.name, Severity::kWarning, process.name,
          fmt::format("{} is silent", process.name), "Is the process, or its host, alive?"};
}

Condition Illness(const ProcessCondition& process) {
  return {"health/" + process.name, Severity::kWarning, process.name,
          fmt::format("{}: {}", process.name, process.message), "See its log."};
}

Condition FailedStorage(const std::string& failure) {
  return {"storage", Severity::kAlarm, "operator", "edits and paths cannot be stored: " + failure,
          "Make room on the disk; nothing that was accepted is lost."};
}

void Add(Findings& findings, bool wrong, Condition condition) {
  if (wrong) {
    findings.wrong.push_back(std::move(condition));
  } else {
    findings.fine.push_back(std::move(condition.key));
  }
}

}  // namespace

bool Stands(const std::vector<AttentionItem>& items, const std::string& robot) {
  return std::ranges::any_of(items, [&](const AttentionItem& item) {
    return item.robot == robot && item.reason == AttentionReason::kCommandFailed;
  });
}

Findings FindingsOf(const std::vector<RobotCondition>& robots,
                    const std::vector<ProcessCondition>& processes,
                    const std::optional<std::string>& storage_failure) {
  Findings findings;
  for (const RobotCondition& robot : robots) {
    Add(findings, robot.lost, LostLink(robot.name));
    Add(findings, robot.stands, FailedCommand(robot.name));
  }
  for (const ProcessCondition& process : processes) {
    Add(findings, process.silent, Silence(process));
    Add(findings, process.failed && !process.silent, Illness(process));
  }
  if (storage_failure) {
    Add(findings, !storage_failure->empty(), FailedStorage(*storage_failure));
  }
  return findings;
}

}  // namespace conav::operators
