#include "operator/alerts/alert_book.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace conav::operators {
namespace {

tl::unexpected<Error> Unknown(std::uint64_t id) {
  return Fail(ErrorCode::kNotFound, fmt::format("alert {} is not known here", id));
}

}  // namespace

void AlertBook::Restore(std::vector<Alert> alerts) {
  for (Alert& alert : alerts) {
    last_id_ = std::max(last_id_, alert.id);
    alerts_[alert.id] = std::move(alert);
  }
}

Alert* AlertBook::FindOpen(const std::string& key) {
  for (auto& [id, alert] : alerts_) {
    if (alert.condition.key == key && !IsHistory(alert)) return &alert;
  }
  return nullptr;
}

AlertBook::Changes AlertBook::Update(const Findings& findings, double now_s) {
  Changes changes;
  for (const std::string& key : findings.fine) {
    Alert* open = FindOpen(key);
    if (open == nullptr || !open->active) continue;
    open->active = false;
    changes.changed.push_back(*open);
  }
  for (const Condition& condition : findings.wrong) Raise(condition, now_s, changes);
  changes.dropped = DropHistory();
  return changes;
}

void AlertBook::Raise(const Condition& condition, double now_s, Changes& changes) {
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
    open->acknowledged_by.clear();
    open->acknowledged_s = 0.0;
  }
  changes.changed.push_back(*open);
}

std::vector<std::uint64_t> AlertBook::DropHistory() {
  std::vector<std::uint64_t> history;  // oldest first
  for (const auto& [id, alert] : alerts_) {
    if (IsHistory(alert)) history.push_back(id);
  }
  history.resize(history.size() - std::min(history.size(), kHistoryKept));
  for (const std::uint64_t id : history) alerts_.erase(id);
  return history;
}

Result<Alert> AlertBook::Acknowledge(std::uint64_t id, const std::string& client,
                                     double now_s) const {
  const auto found = alerts_.find(id);
  if (found == alerts_.end()) return Unknown(id);
  Alert alert = found->second;
  alert.acknowledged_by = client;
  alert.acknowledged_s = now_s;
  return alert;
}

Result<Alert> AlertBook::Shelve(std::uint64_t id, double duration_s, double now_s) const {
  const auto found = alerts_.find(id);
  if (found == alerts_.end()) return Unknown(id);
  Alert alert = found->second;
  alert.shelved_until_s = now_s + duration_s;
  return alert;
}

void AlertBook::Adopt(const Alert& alert) { alerts_[alert.id] = alert; }

}  // namespace conav::operators
