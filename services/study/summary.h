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
  std::size_t all_goals = 0;        // of them, those that reached all goals
  std::vector<MeanSd> measures;     // as Measures(); over episodes, as in the paper's table
  std::vector<double> sd_subjects;  // of the subjects' means
};

/// Of one measure: each subject's mean over the layouts, per method.
struct MeasureAnalysis {
  std::string csv;  // what `conav stats` reads
  std::optional<statistics::Analysis> analysis;
  std::string why_not;  // there is no analysis
};

/// What the study has to show.
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

/// Of the episodes that have a record. A subject with an episode missing or failed has no value for
/// that method: a mean over fewer layouts could not be compared. `records` outlive the summary.
StudySummary Summarise(const Design& design, const Records& records);

/// Subjects x methods as `conav stats` reads it; cells without a value are empty.
std::string SubjectTable(const Design& design, const Records& records, std::size_t measure);

/// Those of which both methods took part.
std::vector<Bar> CheckBars(const std::vector<MethodSummary>& methods);

}  // namespace conav::study
