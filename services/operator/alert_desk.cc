#include "operator/alert_desk.h"

#include <fmt/format.h>

#include <utility>

#include "common/runtime/log.h"

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

Condition OfService(const ServiceStatus& service) {
  if (service.silent) {
    return {"silent/" + service.name, Severity::kWarning, service.name,
            fmt::format("{} is silent", service.name), "Is the process, or its host, alive?"};
  }
  return {"health/" + service.name, Severity::kWarning, service.name,
          fmt::format("{}: {}", service.name, service.message), "See its log."};
}

}  // namespace

std::vector<Condition> ConditionsOf(const std::vector<AttentionItem>& items,
                                    const std::map<std::string, ServiceStatus>& services,
                                    const std::string& storage_failure) {
  std::vector<Condition> conditions;
  for (const AttentionItem& item : items) {
    const bool stands =
        item.reason == AttentionReason::kLinkLost || item.reason == AttentionReason::kCommandFailed;
    if (stands) conditions.push_back(OfItem(item));
  }
  for (const auto& [name, service] : services) {
    if (service.silent || service.level == Health::Level::kError) {
      conditions.push_back(OfService(service));
    }
  }
  if (!storage_failure.empty()) {
    conditions.push_back({"storage", Severity::kAlarm, "operator",
                          "edits and paths cannot be stored: " + storage_failure,
                          "Make room on the disk; nothing that was accepted is lost."});
  }
  return conditions;
}

AlertDesk::AlertDesk(BeliefStore& store) : store_(store) {
  book_.Restore(store.alerts());
  for (const auto& [id, alert] : book_.alerts()) changes_.push_back(alert);
}

bool AlertDesk::Handles(const OperatorRequest& request) {
  return std::holds_alternative<AcknowledgeRequest>(request.body) ||
         std::holds_alternative<ShelveRequest>(request.body);
}

BeliefStore::Answer AlertDesk::Answer(const OperatorRequest& request, double now_s) {
  if (auto repeat = store_.FindRepeat(request)) return *std::move(repeat);
  const auto* acknowledge = std::get_if<AcknowledgeRequest>(&request.body);
  const auto* shelve = std::get_if<ShelveRequest>(&request.body);
  const auto alert = acknowledge != nullptr
                         ? book_.Acknowledge(acknowledge->alert, request.client, now_s)
                         : book_.Shelve(shelve->alert, shelve->duration_s, now_s);
  if (!alert) return {{request.client, request.request_id, false, alert.error().text, 0}};
  BeliefStore::Answer answer = store_.Keep(request, {}, {*alert});
  if (!answer.changed) return answer;
  book_.Adopt(*alert);
  changes_.push_back(*alert);
  return answer;
}

void AlertDesk::Update(const std::vector<Condition>& conditions, double now_s) {
  const std::vector<Alert> changed = book_.Update(conditions, now_s);
  if (changed.empty()) return;
  // That the disk fails is an alert, too: shown although it cannot be stored.
  if (const auto saved = store_.SaveAlerts(changed); !saved) {
    LOG_WARNING("alerts not stored", "reason", saved.error().text);
  }
  changes_.insert(changes_.end(), changed.begin(), changed.end());
}

std::vector<Alert> AlertDesk::TakeChanges() { return std::exchange(changes_, {}); }

}  // namespace conav::operators
