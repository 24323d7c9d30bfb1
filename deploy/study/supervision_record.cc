#include "study/supervision_record.h"

#include <nlohmann/json.hpp>

namespace conav::study {
namespace {

/// Calls visit(key, field) for everything that is kept: the one list for both directions.
template <class Record, class Visit>
void VisitFields(Record& record, Visit&& visit) {
  visit("robots", record.trial.robots);
  visit("order", record.trial.order);
  visit("seed", record.trial.seed);
  visit("failure", record.failure);
  visit("attempts", record.attempts);
  visit("minutes", record.minutes);
  visit("goals", record.goals);
  visit("wall_s", record.wall_s);
  visit("pace", record.pace);
}

template <class Workload, class Visit>
void VisitWorkload(Workload& workload, Visit&& visit) {
  visit("robots", workload.robots);
  visit("interactions", workload.interactions);
  visit("abandoned", workload.abandoned);
  visit("observed_s", workload.observed_s);
  visit("busy_s", workload.busy_s);
  visit("interaction_time_s", workload.interaction_time_s);
  visit("neglect_time_s", workload.neglect_time_s);
  visit("waiting_time_s", workload.waiting_time_s);
  visit("waiting_time_p95_s", workload.waiting_time_p95_s);
  visit("value_lost", workload.value_lost);
  visit("utilisation", workload.utilisation);
  visit("attended_robots", workload.attended_robots);
  visit("fan_out", workload.fan_out);
  visit("fan_out_with_waits", workload.fan_out_with_waits);
  visit("predicted_utilisation", workload.predicted_utilisation);
  visit("predicted_waiting_time_s", workload.predicted_waiting_time_s);
}

auto PutInto(nlohmann::ordered_json& json) {
  return [&json](const char* key, const auto& field) { json[key] = field; };
}

auto TakeFrom(const nlohmann::json& json) {
  return [&json](const char* key, auto& field) { json.at(key).get_to(field); };
}

}  // namespace

nlohmann::ordered_json ToJson(const SupervisionRecord& record) {
  nlohmann::ordered_json json{{"name", record.trial.name()}, {"operator", "simulated"}};
  VisitFields(record, PutInto(json));
  VisitWorkload(record.workload, PutInto(json["workload"]));
  return json;
}

Result<void> FromJson(const std::string& text, SupervisionRecord& record) {
  try {
    const auto json = nlohmann::json::parse(text);
    VisitFields(record, TakeFrom(json));
    VisitWorkload(record.workload, TakeFrom(json.at("workload")));
    return {};
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
}

}  // namespace conav::study
