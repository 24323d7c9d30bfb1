#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/statistics/report.h"
#include "study/study_folder.h"
#include "study/summary.h"

namespace conav::study {

/// A finished study and its results.
struct StudyReport {
  const Design& design;
  const nlohmann::ordered_json& document;  // the design, as in study.json
  const Records& records;
  const StudySummary& summary;
  bool rendered = false;  // pictures had pixels; without, no bytes were sent
  Provenance provenance{};
};

/// False for bytes if pictures had no pixels: zero bytes would say nothing about a method.
bool WasMeasured(const StudyReport& report, const Measure& measure);

/// "SIMULATED operators: 14 synthetic people x 3 methods x 3 layouts = 126 episodes, ...".
std::string Headline(const StudyReport& report);

/// Table 3, the bars, the tests of each measure, the failures.
std::vector<statistics::ReportSection> StudySections(const StudyReport& report);

std::string StudyText(const StudyReport& report);

/// A line per episode, with design and measures; an unmeasured value is empty.
std::string EpisodesCsv(const StudyReport& report);

/// `methods.<method>.<measure>_mean` and `_sd` (over episodes) and `_sd_subjects`; `analyses` as
/// `conav stats --json` writes them. Unmeasured values are null.
nlohmann::ordered_json StudyJson(const StudyReport& report);

/// One self-contained page: the sections, a plot and all tables of each measure, the order of
/// methods per subject, and the provenance of the study.
std::string StudyPage(const StudyReport& report);

}  // namespace conav::study
