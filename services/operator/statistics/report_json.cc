#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "operator/statistics/report.h"

namespace conav::statistics {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json Number(const std::optional<double>& value) { return value ? Number(*value) : Json(); }

Json LeftOutJson(const Analysis& analysis) {
  Json list = Json::array();
  for (const LeftOut& left : analysis.left_out) {
    list.push_back({{"subject", left.subject}, {"line", left.line}, {"missing", left.missing}});
  }
  return list;
}

Json ConditionsJson(const Analysis& analysis) {
  Json list = Json::array();
  for (std::size_t j = 0; j < analysis.conditions.size(); ++j) {
    const Description& row = analysis.conditions[j];
    list.push_back({{"condition", row.condition},
                    {"n", row.n},
                    {"mean", row.mean},
                    {"sd", row.standard_deviation},
                    {"median", row.median},
                    {"ci_low", row.mean_interval.low},
                    {"ci_high", row.mean_interval.high},
                    {"within_ci_low", row.within_interval.low},
                    {"within_ci_high", row.within_interval.high},
                    {"mean_rank", analysis.friedman.mean_ranks[j]}});
  }
  return list;
}

Json CorrectionJson(const std::optional<double>& epsilon, const std::optional<FTest>& test) {
  Json json;
  json["epsilon"] = Number(epsilon);
  json["df_conditions"] = test ? Json(test->df_conditions) : Json();
  json["df_error"] = test ? Json(test->df_error) : Json();
  json["p"] = test ? Number(test->p) : Json();
  return json;
}

Json AnovaJson(const Anova& anova) {
  Sphericity none{.huynh_feldt_raw = {}, .huynh_feldt = {}};
  const Sphericity& sphericity = anova.sphericity ? *anova.sphericity : none;
  const auto epsilon =
      anova.sphericity ? std::optional(sphericity.greenhouse_geisser) : std::nullopt;
  Json json;
  json["ss_conditions"] = anova.ss_conditions;
  json["ss_subjects"] = anova.ss_subjects;
  json["ss_error"] = anova.ss_error;
  json["f"] = Number(anova.f);
  json["df_conditions"] = anova.uncorrected.df_conditions;
  json["df_error"] = anova.uncorrected.df_error;
  json["p"] = Number(anova.uncorrected.p);
  json["greenhouse_geisser"] = CorrectionJson(epsilon, anova.greenhouse_geisser);
  json["huynh_feldt"] = CorrectionJson(sphericity.huynh_feldt, anova.huynh_feldt);
  json["huynh_feldt"]["epsilon_raw"] = Number(sphericity.huynh_feldt_raw);
  json["mauchly"] = {{"w", Number(sphericity.mauchly_w)}, {"p", Number(sphericity.mauchly_p)}};
  json["partial_eta_squared"] = Number(anova.partial_eta_squared);
  json["generalised_eta_squared"] = Number(anova.generalised_eta_squared);
  return json;
}

void AddAdjusted(Json& json, const AdjustedP& adjusted) {
  json["p_holm"] = Number(adjusted.holm);
  json["p_bonferroni"] = Number(adjusted.bonferroni);
  json["p_bh"] = Number(adjusted.bh);
}

Json WilcoxonJson(const Pair& pair) {
  Json json;
  json["used"] = pair.wilcoxon.used;
  json["exact"] = pair.wilcoxon.exact;
  json["v"] = Number(pair.wilcoxon.v);
  json["p"] = Number(pair.wilcoxon.p);
  AddAdjusted(json, pair.wilcoxon_adjusted);
  return json;
}

Json PairJson(const Pair& pair) {
  Json json;
  json["first"] = pair.first;
  json["second"] = pair.second;
  json["mean_difference"] = pair.t.mean_difference;
  json["ci_low"] = pair.t.interval.low;
  json["ci_high"] = pair.t.interval.high;
  json["t"] = Number(pair.t.t);
  json["df"] = pair.t.df;
  json["p"] = Number(pair.t.p);
  AddAdjusted(json, pair.t_adjusted);
  json["d_z"] = Number(pair.t.d_z);
  json["d_av"] = Number(pair.t.d_av);
  json["g_z"] = Number(pair.t.g_z);
  json["wilcoxon"] = WilcoxonJson(pair);
  json["shapiro_wilk"] = {{"w", pair.normality ? Json(pair.normality->w) : Json()},
                          {"p", pair.normality ? Json(pair.normality->p) : Json()}};
  return json;
}

Json FriedmanJson(const Friedman& friedman) {
  return {{"chi_squared", Number(friedman.chi_squared)},
          {"df", friedman.df},
          {"p", Number(friedman.p)},
          {"kendall_w", Number(friedman.kendall_w)}};
}

}  // namespace

Json ReportJson(const Analysis& analysis) {
  Json json;
  json["schema"] = 1;
  json["file"] = analysis.file;
  json["sha256"] = analysis.sha256;
  json["alpha"] = analysis.alpha;
  json["subjects"] = analysis.table.subjects;
  json["left_out"] = LeftOutJson(analysis);
  json["conditions"] = ConditionsJson(analysis);
  json["anova"] = AnovaJson(analysis.anova);
  json["pairs"] = Json::array();
  for (const Pair& pair : analysis.pairs) json["pairs"].push_back(PairJson(pair));
  json["friedman"] = FriedmanJson(analysis.friedman);
  json["notes"] = analysis.notes;
  return json;
}

}  // namespace conav::statistics
