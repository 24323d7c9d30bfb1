#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/report_page.h"
#include "study/statistics/analysis.h"
#include "study/study_episode.h"

namespace conav::study {

/// Mean and standard deviation (n - 1; 0 for fewer than two values).
struct MeanSd {
  double mean = 0.0;
  double sd = 0.0;
};

/// A row of table 3.
struct MethodSummary {
  StudyRow row;
  std::size_t episodes = 0;         // with measures
  std::size_t all_goals = 0;        // of these, those that reached all goals
  std::vector<MeanSd> measures;     // as Measures(); over episodes, as in the paper's table
  std::vector<double> sd_subjects;  // of the subjects' means
  HumanTime human;                  // means over episodes
};

/// One measure: each subject's mean over the layouts, per method.
struct MeasureAnalysis {
  std::string csv;  // the input of `conav stats`
  std::optional<statistics::Analysis> analysis;
  std::string why_not;  // the reason for a missing analysis
};

/// A result that the study must show.
struct Bar {
  std::string key;   // in JSON
  std::string text;  // what is measured, for people
  double value = 0.0;
  double limit = 0.0;
  enum class Kind { kAtLeast, kAtMost, kBelow } kind = Kind::kAtLeast;

  bool met() const;
};

struct StudySummary {
  std::vector<MethodSummary> methods;
  std::vector<MeasureAnalysis> analyses;  // as Measures(), of the methods
  /// Low-level steps of all rows, ig-mcts tested for equivalence with each other one.
  MeasureAnalysis comparable;
  /// The forward speed at which teleop would take the steps of ig-mcts: between two speeds of the
  /// table, linear in steps over 1 / speed. Empty where none of them lies on the other side.
  std::optional<double> break_even_mps;
  std::vector<Bar> bars;
  std::vector<const EpisodeRecord*> failed;  // no measures
  std::vector<const EpisodeRecord*> goals_left;
};

using Records = std::map<std::string, EpisodeRecord>;

/// Summarises the recorded episodes. A subject with a missing or failed episode has no value for
/// that method, since means over fewer layouts are not comparable. `records` outlive the summary.
StudySummary Summarise(const Design& design, const Records& records);

/// Subjects x the first `rows` of the design in the format of `conav stats`; missing values are empty
/// cells.
std::string SubjectTable(const Design& design, const Records& records, std::size_t measure,
                         std::span<const StudyRow> rows);

/// Fills in EpisodeMeasures::human.
void EstimateHumanTimes(const Design& design, const operators::InteractionTimeParameters& times,
                        Records& records);

/// The bars for which both methods took part.
std::vector<Bar> CheckBars(const std::vector<MethodSummary>& methods);

/// A finished study and its results.
struct StudyReport {
  const Design& design;
  const nlohmann::ordered_json& document;  // the design, as in study.json
  const Records& records;
  const StudySummary& summary;
  bool rendered = false;  // pictures had pixels; without, no bytes were sent
  Provenance provenance{};
  operators::InteractionTimeParameters interaction{};  // of EstimateHumanTimes()
  bool encoded = false;                                // streams were encoded as H.264
};

/// False for bytes if pictures had no pixels: zero bytes would say nothing about a method.
bool WasMeasured(const StudyReport& report, const Measure& measure);

/// "SIMULATED operators: 14 synthetic people x 3 methods x 3 layouts = 126 episodes, ...".
std::string Headline(const StudyReport& report);

/// Table 3, the bars, the tests of each measure, the failures.
std::vector<ReportSection> StudySections(const StudyReport& report);

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
