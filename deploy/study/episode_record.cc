#include "study/episode_record.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

namespace conav::study {
namespace {

constexpr std::pair<EpisodeStatus, const char*> kStatusNames[] = {
    {EpisodeStatus::kComplete, "complete"},
    {EpisodeStatus::kGoalsLeft, "goals left"},
    {EpisodeStatus::kFailed, "failed"},
};

constexpr std::pair<const char*, double EpisodeMeasures::*> kFields[] = {
    {"pictures", &EpisodeMeasures::pictures},
    {"picture_bytes", &EpisodeMeasures::picture_bytes},
    {"low_level_steps", &EpisodeMeasures::low_level_steps},
    {"cell_moves", &EpisodeMeasures::cell_moves},
    {"guidance", &EpisodeMeasures::guidance},
    {"mapping_accuracy_after", &EpisodeMeasures::mapping_accuracy_after},
    {"goals_reached", &EpisodeMeasures::goals_reached},
    {"goals_total", &EpisodeMeasures::goals_total},
    {"time_s", &EpisodeMeasures::time_s},
};

Result<EpisodeStatus> StatusFrom(const std::string& name) {
  const auto found = std::find_if(std::begin(kStatusNames), std::end(kStatusNames),
                                  [&](const auto& entry) { return name == entry.second; });
  if (found != std::end(kStatusNames)) return found->first;
  return Fail(ErrorCode::kMalformed, "status '" + name + "' is not known");
}

EpisodeMeasures MeasuresFrom(const nlohmann::json& json) {
  EpisodeMeasures measures;
  for (const auto& [key, field] : kFields) measures.*field = json.at(key).get<double>();
  measures.all_goals_reached = json.at("all_goals_reached").get<bool>();
  return measures;
}

}  // namespace

const char* NameOf(EpisodeStatus status) {
  return std::find_if(std::begin(kStatusNames), std::end(kStatusNames),
                      [&](const auto& entry) { return entry.first == status; })
      ->second;
}

nlohmann::ordered_json ToJson(const EpisodeRecord& record) {
  nlohmann::ordered_json json{{"name", record.name},     {"status", NameOf(record.status)},
                              {"detail", record.detail}, {"attempts", record.attempts},
                              {"wall_s", record.wall_s}, {"run", record.run},
                              {"operator", "simulated"}, {"measures", nullptr}};
  if (!record.measures) return json;
  nlohmann::ordered_json measures;
  for (const auto& [key, field] : kFields) measures[key] = (*record.measures).*field;
  measures["all_goals_reached"] = record.measures->all_goals_reached;
  json["measures"] = std::move(measures);
  return json;
}

Result<void> FromJson(const std::string& text, EpisodeRecord& record) {
  try {
    const auto json = nlohmann::json::parse(text);
    const auto status = StatusFrom(json.at("status").get<std::string>());
    if (!status) return tl::unexpected(status.error());
    record = {.name = json.at("name").get<std::string>(),
              .status = *status,
              .detail = json.at("detail").get<std::string>(),
              .attempts = json.at("attempts").get<int>(),
              .wall_s = json.at("wall_s").get<double>(),
              .run = json.at("run").get<std::string>()};
    if (!json.at("measures").is_null()) record.measures = MeasuresFrom(json.at("measures"));
    if (record.measures.has_value() == record.has_failed()) {
      return Fail(ErrorCode::kMalformed, "status and measures contradict each other");
    }
    return {};
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
}

}  // namespace conav::study
