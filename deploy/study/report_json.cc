#include <nlohmann/json.hpp>

#include "operator/statistics/report.h"
#include "study/report.h"

namespace conav::study {
namespace {

using Json = nlohmann::ordered_json;

/// A share is a mean already: its key says so itself.
std::string MeanKey(const std::string& key) {
  return key == "goals_reached_fraction" ? key : key + "_mean";
}

Json MethodJson(const StudyReport& report, const MethodSummary& method) {
  Json json{{"episodes", method.episodes}, {"episodes_with_all_goals", method.all_goals}};
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const std::string key = Measures()[m].key;
    const bool known = method.episodes > 0 && WasMeasured(report, Measures()[m]);
    json[MeanKey(key)] = known ? Json(method.measures[m].mean) : Json();
    json[key + "_sd"] = known ? Json(method.measures[m].sd) : Json();
    json[key + "_sd_subjects"] = known ? Json(method.sd_subjects[m]) : Json();
  }
  return json;
}

Json BarsJson(const std::vector<Bar>& bars) {
  Json list = Json::array();
  for (const Bar& bar : bars) {
    list.push_back({{"key", bar.key},
                    {"text", bar.text},
                    {"value", bar.value},
                    {"limit", bar.limit},
                    {"met", bar.met()}});
  }
  return list;
}

Json TroubleJson(const std::vector<const EpisodeRecord*>& records) {
  Json list = Json::array();
  for (const EpisodeRecord* record : records) list.push_back(ToJson(*record));
  return list;
}

}  // namespace

Json StudyJson(const StudyReport& report) {
  const StudySummary& summary = report.summary;
  Json json{{"schema", 1},
            {"simulated", true},
            {"note", Headline(report)},
            {"design", report.document},
            {"methods", Json::object()},
            {"bars", BarsJson(summary.bars)},
            {"failed", TroubleJson(summary.failed)},
            {"goals_left", TroubleJson(summary.goals_left)},
            {"analyses", Json::object()}};
  for (const MethodSummary& method : summary.methods) {
    json["methods"][method.method] = MethodJson(report, method);
  }
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const auto& analysis = summary.analyses[m].analysis;
    const bool known = analysis && WasMeasured(report, Measures()[m]);
    json["analyses"][Measures()[m].key] = known ? statistics::ReportJson(*analysis) : Json();
  }
  return json;
}

}  // namespace conav::study
