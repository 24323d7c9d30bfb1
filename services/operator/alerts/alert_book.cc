#include "operator/alerts/alert_book.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace conav::operators {
namespace {

bool IsHistory(const Alert& alert) { return !alert.active && !alert.acknowledged_by.empty(); }

tl::unexpected<Error> Unknown(std::uint64_t id) {
  return Fail(ErrorCode::kNotFound, fmt::format("alert {} is not known here", id));
}

}  // namespace

void AlertBook::Restore(std::vector<Alert> alerts) {
  for (Alert& alert : alerts) {
    alert.active = false;
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

std::vector<Alert> AlertBook::Update(const std::vector<Condition>& conditions, double now_s) {
  std::map<std::uint64_t, Alert> before = alerts_;
  for (auto& entry : alerts_) {
    Alert& alert = entry.second;
    alert.active = std::any_of(conditions.begin(), conditions.end(), [&](const Condition& c) {
      return alert.active && c.key == alert.condition.key;
    });
  }
  for (const Condition& condition : conditions) {
    Alert* open = FindOpen(condition.key);
    if (open == nullptr) {
      ++last_id_;
      alerts_[last_id_] = {
          .id = last_id_, .condition = condition, .raised_s = now_s, .newest_s = now_s};
      continue;
    }
    open->condition = condition;
    if (open->active) continue;
    open->active = true;
    open->newest_s = now_s;
    ++open->count;
    open->acknowledged_by.clear();
    open->acknowledged_s = 0.0;
  }
  std::vector<Alert> changed;
  for (const auto& [id, alert] : alerts_) {
    const auto known = before.find(id);
    if (known == before.end() || known->second != alert) changed.push_back(alert);
  }
  return changed;
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
