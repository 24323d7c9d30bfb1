#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/statistics/report.h"
#include "study/study_folder.h"
#include "study/summary.h"

namespace conav::study {

/// A finished study and what came of it.
struct StudyReport {
  const Design& design;
  const nlohmann::ordered_json& document;  // the design as study.json has it
  const Records& records;
  const StudySummary& summary;
  bool rendered = false;  // pictures had pixels; without, no bytes were sent
  Provenance provenance{};
};

/// Without pixels no bytes were sent, which says nothing about a method.
bool WasMeasured(const StudyReport& report, const Measure& measure);

/// "SIMULATED operators: 14 synthetic people x 3 methods x 3 layouts = 126 episodes, ...".
std::string Headline(const StudyReport& report);

/// Table 3, the bars, the tests of each measure, what failed.
std::vector<statistics::ReportSection> StudySections(const StudyReport& report);

std::string StudyText(const StudyReport& report);

/// A line per episode, design and measures; what was not measured is empty.
std::string EpisodesCsv(const StudyReport& report);

/// `methods.<method>.<measure>_mean` and `_sd` (over episodes) and `_sd_subjects`; `analyses` as
/// `conav stats --json` writes them. What was not measured is null.
nlohmann::ordered_json StudyJson(const StudyReport& report);

/// One page without any other file: the sections, a plot and all tables of each measure, who had
/// which method when, and how the study was made.
std::string StudyPage(const StudyReport& report);

}  // namespace conav::study
