#include "operator/supervision/alert_topics.h"

#include <utility>

#include "common/runtime/log.h"

namespace conav::operators {

void ServiceMonitor::Step() {
  const Clock::TimePoint now = clock_.Now();
  for (const auto& array : diagnostics_.Take()) {
    for (const ReportedHealth& health : HealthOf(array)) {
      services_[health.process] = {health.process, health.level, health.message, now, false};
    }
  }
  for (auto& [name, service] : services_) service.silent = now - service.received_at > kSilentAfter;
}

namespace {

std::vector<ProcessCondition> ProcessesOf(const std::map<std::string, ServiceStatus>& services) {
  std::vector<ProcessCondition> processes;
  for (const auto& [name, service] : services) {
    const bool failed = service.level == Health::Level::kError;
    processes.push_back({name, failed, service.silent, service.message});
  }
  return processes;
}

}  // namespace

AlertTopics::AlertTopics(BeliefStore& store) : store_(store) {
  registry_.Restore(store.alerts());
  for (const auto& [id, alert] : registry_.alerts()) changes_.push_back(alert);
}

bool AlertTopics::Handles(const OperatorRequest& request) {
  return std::holds_alternative<AcknowledgeRequest>(request.body) ||
         std::holds_alternative<ShelveRequest>(request.body);
}

BeliefStore::Answer AlertTopics::Answer(const OperatorRequest& request, double now_s) {
  const auto* acknowledge = std::get_if<AcknowledgeRequest>(&request.body);
  const auto* shelve = std::get_if<ShelveRequest>(&request.body);
  const auto alert = acknowledge != nullptr
                         ? registry_.Acknowledge(acknowledge->alert, request.client, now_s)
                         : registry_.Shelve(shelve->alert, shelve->duration_s, now_s);
  if (!alert) return {Refusal(request, alert.error().text)};
  BeliefStore::Answer answer = store_.Keep(request, {}, {*alert});
  if (!answer.changed) return answer;
  registry_.Adopt(*alert);
  changes_.push_back(*alert);
  return answer;
}

void AlertTopics::Update(const std::vector<RobotCondition>& robots,
                         const std::map<std::string, ServiceStatus>& services,
                         const std::optional<std::string>& storage_failure, double now_s) {
  const auto [changed, dropped] =
      registry_.Update(FindingsOf(robots, ProcessesOf(services), storage_failure), now_s);
  if (changed.empty() && dropped.empty()) return;
  // That the disk fails is an alert, too: shown although it cannot be stored.
  if (const auto saved = store_.SaveAlerts(changed, dropped); !saved) {
    LOG_WARNING("alerts not stored", "reason", saved.error().text);
  }
  changes_.insert(changes_.end(), changed.begin(), changed.end());
}

std::vector<Alert> AlertTopics::TakeChanges() { return std::exchange(changes_, {}); }

}  // namespace conav::operators
