#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/gaze/gaze_report.h"
#include "study/live_results.h"
#include "study/report_page.h"
#include "study/statistics/analysis.h"

namespace conav::study {

/// Each participant's mean with each condition, and what the tests say of it.
struct ConditionAnalysis {
  std::string file;  // measures/<measure>.csv, or measures/<measure>-by-position.csv
  std::string csv;
  std::optional<statistics::Analysis> analysis;
  std::string why_not;  // there is none
};

struct TestedMeasure {
  LiveMeasure measure;
  ConditionAnalysis by_method;
  ConditionAnalysis by_position;
  std::optional<statistics::SamplePlan> plan;
};

struct LiveReport {
  LiveStudy study;
  std::vector<LiveMeasure> measures;
  std::vector<TestedMeasure> tested;
  std::vector<LiveColumn> columns;
  std::string to_study;  // from the page's folder: "", or "../study-x/"
  Provenance provenance;
};

/// The measure whose plan stands for all of them.
inline constexpr const char* kAllMeasures = "all";

/// Analyses a study for a page in `out`. `power`: the measures whose sample sizes are simulated. Errors:
/// kInvalidArgument: there is no such measure, or it is not tested; those that are, are named.
[[nodiscard]] Result<LiveReport> MakeLiveReport(LiveStudy study, const std::filesystem::path& out,
                                                const std::vector<std::string>& power,
                                                Provenance provenance);

/// "4 participants started: 2 count, 1 incomplete, ...".
std::string LiveHeadline(const LiveReport& report);

/// The tables of the report, in its order.
std::vector<ReportSection> LiveSections(const LiveReport& report);

std::string LiveText(const LiveReport& report);

/// The numbers of the page. docs/study.md says what there is.
nlohmann::ordered_json LiveJson(const LiveReport& report);

/// One self-contained page, each table with links to the files that its figures come from.
std::string LivePage(const LiveReport& report);

/// The eye measures of the participants that count, as `conav gaze` reports them.
std::vector<gaze::MeasuredRecording> EyeRecordings(const LiveStudy& study);

/// A participant's values in trials that `is_wanted`; those without the measure are left out.
std::vector<double> ValuesOf(const LiveParticipant& participant, const LiveMeasure& measure,
                             const std::function<bool(const LiveTrial&)>& is_wanted);
/// Of all trials with a method, of the participants that count.
std::vector<double> ValuesOf(const LiveStudy& study, const LiveMeasure& measure,
                             const std::string& method);

/// All files of the report by name: report.html, trials.csv, codebook.csv, measures/.
std::map<std::string, std::string> LiveFiles(const LiveReport& report);

}  // namespace conav::study
