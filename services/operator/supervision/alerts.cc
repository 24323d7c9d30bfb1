#include "operator/supervision/alerts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/clock_offset.h"

namespace conav::operators {
namespace {

Condition LostLink(const std::string& robot) {
  return {"link/" + robot, Severity::kAlarm, robot, fmt::format("{} is no longer connected", robot),
          "Look at its last known place. Check that its simulator and radio are alive."};
}

Condition FailedCommand(const std::string& robot) {
  return {"command/" + robot, Severity::kWarning, robot,
          fmt::format("{} is standing still: its command was refused or expired", robot),
          "Check that its planner is alive. Draw it another path, or stop it."};
}

Condition ResumedElsewhere(const std::string& robot) {
  return {"resumed/" + robot, Severity::kAlarm, robot,
          fmt::format("another program resumed {}, which was stopped here; it was stopped again",
                      robot),
          fmt::format("Find what publishes /{}/stop: another operator service, or a script. Resume "
                      "the robot here when it may move.",
                      robot)};
}

Condition UnconfirmedStop(const std::string& robot) {
  return {"stop/" + robot, Severity::kAlarm, robot,
          fmt::format("{} does not confirm that it was stopped", robot),
          "It may still move: use the emergency stop on the robot. Check its driver and radio."};
}

Condition UnusableMap(const std::string& robot, const std::string& problem) {
  return {
      "map/" + robot, Severity::kAlarm, robot, problem,
      "Publish both on the same cells: same resolution, size and origin. Until then the robot is "
      "not shown, and no planner moves it."};
}

Condition WrongGoals(const std::string& robot, const std::string& problem) {
  return {"goals/" + robot, Severity::kAlarm, robot, problem,
          "One program owns a robot's goals: end the other, or take the robot out of "
          "operator.goals.robots. Check that the goals lie on its map."};
}

Condition Silence(const ProcessCondition& process) {
  return {"silent/" + process.name, Severity::kWarning, process.name,
          fmt::format("{} is silent", process.name),
          "Check that the process and its host are alive."};
}

Condition Restart(const ProcessCondition& process) {
  return {"restarted/" + process.name, Severity::kWarning, process.name,
          fmt::format("{} has restarted{}{}", process.name, process.kept.empty() ? "" : "; ",
                      process.kept),
          "It goes on by itself. If it restarts again, see its log."};
}

Condition Illness(const ProcessCondition& process) {
  return {"health/" + process.name, Severity::kWarning, process.name,
          fmt::format("{}: {}", process.name, process.message), "See its log."};
}

Condition OtherSystem(const std::string& name) {
  return {"system/" + name, Severity::kWarning, "operator",
          fmt::format("another system, {}, is in this DDS domain; its messages are ignored", name),
          "If it is not yours, give one of them another domain (CONAV_DOMAIN). If it is, give its "
          "programs this system's name (bus.system, CONAV_SYSTEM)."};
}

Condition WrongClock(const ClockCondition& clock) {
  return {"clock/" + clock.host, Severity::kWarning, clock.host,
          fmt::format("the clock of {} is more than {} s {} this host's", clock.host, kClockLimitS,
                      clock.ahead_s > 0.0 ? "ahead of" : "behind"),
          "Ages are corrected for it, recordings are not. Set the clocks by NTP: `apt-get install "
          "chrony` on both "
          "hosts, then `chronyc makestep` on the one that is wrong."};
}

Condition FailedStorage(const std::string& failure) {
  return {"storage", Severity::kAlarm, "operator", "edits and paths cannot be stored: " + failure,
          "Free space on the disk. Nothing that was accepted is lost."};
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
                    const std::optional<std::string>& storage_failure,
                    const std::vector<SystemCondition>& other_systems,
                    const std::vector<ClockCondition>& clocks) {
  Findings findings;
  for (const RobotCondition& robot : robots) {
    Add(findings, robot.lost, LostLink(robot.name));
    Add(findings, robot.stands, FailedCommand(robot.name));
    Add(findings, robot.resumed_elsewhere, ResumedElsewhere(robot.name));
    Add(findings, robot.stop_unconfirmed, UnconfirmedStop(robot.name));
    Add(findings, !robot.map_problem.empty(), UnusableMap(robot.name, robot.map_problem));
    Add(findings, !robot.goals_problem.empty(), WrongGoals(robot.name, robot.goals_problem));
  }
  for (const ProcessCondition& process : processes) {
    Add(findings, process.silent, Silence(process));
    Add(findings, process.failed && !process.silent, Illness(process));
    Add(findings, process.restarted, Restart(process));
  }
  if (storage_failure) {
    Add(findings, !storage_failure->empty(), FailedStorage(*storage_failure));
  }
  for (const SystemCondition& system : other_systems) {
    Add(findings, system.just_met, OtherSystem(system.name));
  }
  for (const ClockCondition& clock : clocks) {
    Add(findings, std::abs(clock.ahead_s) - clock.error_s > kClockLimitS, WrongClock(clock));
  }
  return findings;
}

namespace {

tl::unexpected<Error> Unknown(std::uint64_t id) {
  return Fail(ErrorCode::kNotFound, fmt::format("alert {} is unknown", id));
}

}  // namespace

void AlertRegistry::Restore(std::vector<Alert> alerts) {
  for (Alert& alert : alerts) {
    last_id_ = std::max(last_id_, alert.id);
    alerts_[alert.id] = std::move(alert);
  }
}

Alert* AlertRegistry::FindOpen(const std::string& key) {
  for (auto& [id, alert] : alerts_) {
    if (alert.condition.key == key && !IsHistory(alert)) return &alert;
  }
  return nullptr;
}

AlertRegistry::Changes AlertRegistry::Update(const Findings& findings, double now_s) {
  Changes changes;
  for (const std::string& key : findings.fine) {
    Alert* open = FindOpen(key);
    if (open == nullptr || !open->active) continue;
    open->active = false;
    changes.changed.push_back(*open);
  }
  for (const Condition& condition : findings.wrong) Raise(condition, now_s, changes);
  CloseOldWarnings(now_s, changes);
  changes.dropped = DropHistory();
  return changes;
}

void AlertRegistry::Raise(const Condition& condition, double now_s, Changes& changes) {
  Alert* open = FindOpen(condition.key);
  if (open == nullptr) {
    ++last_id_;
    alerts_[last_id_] = {
        .id = last_id_, .condition = condition, .raised_s = now_s, .newest_s = now_s};
    changes.changed.push_back(alerts_[last_id_]);
    return;
  }
  if (open->active && open->condition == condition) return;
  open->condition = condition;
  if (!open->active) {
    open->active = true;
    open->newest_s = now_s;
    ++open->count;
  }
  changes.changed.push_back(*open);
}

void AlertRegistry::CloseOldWarnings(double now_s, Changes& changes) {
  std::vector<Alert*> open;  // oldest first
  for (auto& [id, alert] : alerts_) {
    if (!IsHistory(alert) && alert.condition.severity == Severity::kWarning) open.push_back(&alert);
  }
  open.resize(open.size() - std::min(open.size(), kWarningsKept));
  for (Alert* alert : open) {
    alert->active = false;
    alert->acknowledged_by = "too many warnings";
    alert->acknowledged_s = now_s;
    changes.changed.push_back(*alert);
  }
}

std::vector<std::uint64_t> AlertRegistry::DropHistory() {
  std::vector<std::uint64_t> history;  // oldest first
  for (const auto& [id, alert] : alerts_) {
    if (IsHistory(alert)) history.push_back(id);
  }
  history.resize(history.size() - std::min(history.size(), kHistoryKept));
  for (const std::uint64_t id : history) alerts_.erase(id);
  return history;
}

Result<Alert> AlertRegistry::Acknowledge(std::uint64_t id, const std::string& client,
                                         double now_s) const {
  const auto found = alerts_.find(id);
  if (found == alerts_.end()) return Unknown(id);
  Alert alert = found->second;
  alert.acknowledged_by = client;
  alert.acknowledged_s = now_s;
  return alert;
}

Result<Alert> AlertRegistry::Shelve(std::uint64_t id, double duration_s, double now_s) const {
  const auto found = alerts_.find(id);
  if (found == alerts_.end()) return Unknown(id);
  Alert alert = found->second;
  alert.shelved_until_s = now_s + duration_s;
  return alert;
}

void AlertRegistry::Adopt(const Alert& alert) { alerts_[alert.id] = alert; }

}  // namespace conav::operators
