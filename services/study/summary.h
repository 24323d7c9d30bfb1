#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/episode_record.h"
#include "study/statistics/analysis.h"

namespace conav::study {

/// Mean and standard deviation (n - 1; 0 for fewer than two values).
struct MeanSd {
  double mean = 0.0;
  double sd = 0.0;
};

/// A row of table 3.
struct MethodSummary {
  std::string method;
  std::size_t episodes = 0;         // with measures
  std::size_t all_goals = 0;        // of these, those that reached all goals
  std::vector<MeanSd> measures;     // as Measures(); over episodes, as in the paper's table
  std::vector<double> sd_subjects;  // of the subjects' means
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
  std::vector<MeasureAnalysis> analyses;  // as Measures()
  std::vector<Bar> bars;
  std::vector<const EpisodeRecord*> failed;  // no measures
  std::vector<const EpisodeRecord*> goals_left;
};

using Records = std::map<std::string, EpisodeRecord>;

/// Summarises the recorded episodes. A subject with a missing or failed episode has no value for
/// that method, since means over fewer layouts are not comparable. `records` outlive the summary.
StudySummary Summarise(const Design& design, const Records& records);

/// Subjects x methods in the format of `conav stats`; missing values are empty cells.
std::string SubjectTable(const Design& design, const Records& records, std::size_t measure);

/// The bars for which both methods took part.
std::vector<Bar> CheckBars(const std::vector<MethodSummary>& methods);

}  // namespace conav::study
