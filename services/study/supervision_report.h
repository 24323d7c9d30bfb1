#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/statistics/report.h"
#include "study/supervision_measures.h"

namespace conav::study {

/// "SIMULATED operator: 5 team sizes x 3 orders x 10 seeds = 150 trials of 3 min, ...".
std::string SupervisionHeadline(const SupervisionOptions& options,
                                const SupervisionSummary& summary);

/// The table, measured against predicted, the orders against each other, the failures.
std::vector<statistics::ReportSection> SupervisionSections(const SupervisionSummary& summary);

std::string SupervisionText(const SupervisionOptions& options, const SupervisionSummary& summary);

/// A line per trial: robots, order, seed, every measure; an unmeasured value is empty.
std::string SupervisionCsv(const std::vector<SupervisionRecord>& records);

/// `cells` (robots, order, trials, <measure>_mean, <measure>_half_interval), `comparisons`,
/// `failed`, `slow`, and `metrics` with <measure>_<order>_<robots> for goals_per_minute, waiting_s,
/// value_lost_per_minute, utilisation and attended_robots. Unmeasured values are null: means
/// without a measured trial, intervals of fewer than two, p if all seeds differ by the same.
nlohmann::ordered_json SupervisionJson(const SupervisionOptions& options,
                                       const SupervisionSummary& summary);

/// Throughput, waiting time, utilisation and fan-out over the number of robots, a line per order
/// with its 95 % interval, predictions dashed. An SVG document.
std::string SupervisionPlot(const SupervisionOptions& options, const SupervisionSummary& summary);

/// One self-contained page; `made` is a ProvenanceSection().
std::string SupervisionPage(const SupervisionOptions& options, const SupervisionSummary& summary,
                            const statistics::ReportSection& made);

}  // namespace conav::study
