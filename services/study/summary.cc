#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "study/report.h"
#include "study/statistics/moments.h"

namespace conav::study {
namespace {

MeanSd Describe(std::span<const double> values) {
  if (values.empty()) return {};
  return {statistics::Mean(values), statistics::StandardDeviation(values)};
}

constexpr double HumanTime::*kHumanTimes[] = {&HumanTime::low, &HumanTime::middle, &HumanTime::high,
                                              &HumanTime::waiting};

const EpisodeRecord* Find(const Records& records, const std::string& name) {
  const auto found = records.find(name);
  return found == records.end() ? nullptr : &found->second;
}

/// Mean over the layouts; empty if one is missing.
std::optional<double> SubjectMean(const Design& design, const Records& records, int subject,
                                  const StudyRow& row, std::size_t measure) {
  double sum = 0.0;
  for (const PlannedEpisode& episode : design.episodes) {
    if (episode.subject != subject || episode.row != row) continue;
    const EpisodeRecord* record = Find(records, episode.name);
    if (record == nullptr || !record->measures) return std::nullopt;
    sum += Measures()[measure].value(*record->measures);
  }
  return sum / static_cast<double>(design.layouts.size());
}

MethodSummary SummariseRow(const Design& design, const Records& records, const StudyRow& row) {
  MethodSummary summary{.row = row};
  std::vector<std::vector<double>> values(Measures().size());
  for (const PlannedEpisode& episode : design.episodes) {
    const EpisodeRecord* record = Find(records, episode.name);
    if (episode.row != row || record == nullptr || !record->measures) continue;
    ++summary.episodes;
    if (record->measures->all_goals_reached) ++summary.all_goals;
    for (std::size_t m = 0; m < values.size(); ++m) {
      values[m].push_back(Measures()[m].value(*record->measures));
    }
    for (const auto field : kHumanTimes) summary.human.*field += record->measures->human.*field;
  }
  const auto episodes = static_cast<double>(std::max<std::size_t>(1, summary.episodes));
  for (const auto field : kHumanTimes) summary.human.*field /= episodes;
  for (std::size_t m = 0; m < values.size(); ++m) {
    summary.measures.push_back(Describe(values[m]));
    std::vector<double> means;
    for (int subject = 0; subject < static_cast<int>(design.subjects.size()); ++subject) {
      const auto mean = SubjectMean(design, records, subject, row, m);
      if (mean) means.push_back(*mean);
    }
    summary.sd_subjects.push_back(Describe(means).sd);
  }
  return summary;
}

MeasureAnalysis AnalyseMeasure(const Design& design, const Records& records, std::size_t measure,
                               std::span<const StudyRow> rows) {
  MeasureAnalysis result{.csv = SubjectTable(design, records, measure, rows)};
  const std::string file = std::string(Measures()[measure].key) + ".csv";
  auto analysis = statistics::AnalyseText(result.csv, file, statistics::kAlpha);
  if (analysis) {
    result.analysis = *std::move(analysis);
  } else {
    result.why_not = analysis.error().text;
  }
  return result;
}

/// IG-MCTS first, as the tests of equivalence are of the first of a pair.
MeasureAnalysis CompareSteps(const Design& design, const Records& records) {
  std::vector<StudyRow> rows = design.rows;
  const std::string ig_mcts(Name(MethodKind::kIgMcts));
  std::stable_partition(rows.begin(), rows.end(),
                        [&](const StudyRow& row) { return row.name == ig_mcts; });
  MeasureAnalysis steps = AnalyseMeasure(design, records, MeasureIndex("low_level_steps"), rows);
  if (steps.analysis) {
    statistics::AddEquivalence(*steps.analysis, statistics::kEquivalenceMargin, true, ig_mcts);
  }
  return steps;
}

double MeanOf(const MethodSummary& method, const char* measure) {
  return method.measures[MeasureIndex(measure)].mean;
}

std::optional<double> BreakEvenSpeed(const std::vector<MethodSummary>& methods) {
  std::map<double, double> steps_at;  // of teleop, by 1 / speed
  std::optional<double> steps;        // of IG-MCTS
  for (const MethodSummary& method : methods) {
    if (method.episodes == 0) continue;
    const double mean = MeanOf(method, "low_level_steps");
    if (method.row.method == MethodKind::kTeleop) steps_at[1.0 / method.row.teleop_mps] = mean;
    if (method.row.name == Name(MethodKind::kIgMcts)) steps = mean;
  }
  for (auto fast = steps_at.begin(); steps && fast != steps_at.end(); ++fast) {
    const auto slow = std::next(fast);
    if (slow == steps_at.end() || *steps < fast->second || *steps > slow->second) continue;
    const double share = (*steps - fast->second) / (slow->second - fast->second);
    return 1.0 / std::lerp(fast->first, slow->first, share);
  }
  return std::nullopt;
}

Bar ImageBar(const MethodSummary& ig_mcts, const MethodSummary& baseline) {
  const double streamed = MeanOf(baseline, "image_mib");
  return {.key = fmt::format("image_bytes_saved_against_{}", baseline.row.name),
          .text = fmt::format("image bytes that ig-mcts saves against {}", baseline.row.name),
          .value = streamed > 0.0 ? 1.0 - MeanOf(ig_mcts, "image_mib") / streamed : 0.0,
          .limit = 0.97,
          .kind = Bar::Kind::kAtLeast};
}

Bar StepsBar(const MethodSummary& ig_mcts, const MethodSummary& baseline, double limit,
             Bar::Kind kind) {
  const double steps = MeanOf(baseline, "low_level_steps");
  return {.key = fmt::format("steps_ratio_to_{}", baseline.row.name),
          .text = fmt::format("low-level steps of ig-mcts over those of {}", baseline.row.name),
          .value = steps > 0.0 ? MeanOf(ig_mcts, "low_level_steps") / steps : 0.0,
          .limit = limit,
          .kind = kind};
}

Bar GoalsBar(const std::vector<MethodSummary>& methods) {
  Bar bar{.key = "episodes_with_all_goals",
          .text = "episodes in which all goals were reached, all methods",
          .limit = 1.0,
          .kind = Bar::Kind::kAtLeast};
  std::size_t episodes = 0;
  std::size_t good = 0;
  for (const MethodSummary& method : methods) {
    episodes += method.episodes;
    good += method.all_goals;
  }
  if (episodes > 0) bar.value = static_cast<double>(good) / static_cast<double>(episodes);
  return bar;
}

}  // namespace

void EstimateHumanTimes(const Design& design, const operators::InteractionTimeParameters& times,
                        Records& records) {
  for (const PlannedEpisode& episode : design.episodes) {
    const auto found = records.find(episode.name);
    if (found == records.end() || !found->second.measures) continue;
    EpisodeMeasures& measures = *found->second.measures;
    measures.human = HumanTimeOf(episode.row.method, measures, times);
  }
}

bool Bar::met() const {
  if (kind == Kind::kBelow) return value < limit;
  return kind == Kind::kAtMost ? value <= limit : value >= limit;
}

std::string SubjectTable(const Design& design, const Records& records, std::size_t measure,
                         std::span<const StudyRow> rows) {
  std::string csv = "subject";
  for (const StudyRow& row : rows) csv += "," + row.name;
  csv += "\n";
  for (std::size_t subject = 0; subject < design.subjects.size(); ++subject) {
    csv += design.subjects[subject];
    for (const StudyRow& row : rows) {
      csv += CsvCell(SubjectMean(design, records, static_cast<int>(subject), row, measure));
    }
    csv += "\n";
  }
  return csv;
}

std::vector<Bar> CheckBars(const std::vector<MethodSummary>& methods) {
  const auto find = [&](MethodKind method) -> const MethodSummary* {
    const auto found = std::find_if(methods.begin(), methods.end(), [&](const MethodSummary& m) {
      return m.row.name == Name(method) && m.episodes > 0;
    });
    return found == methods.end() ? nullptr : &*found;
  };
  std::vector<Bar> bars;
  const MethodSummary* ig_mcts = find(MethodKind::kIgMcts);
  const MethodSummary* instruction = find(MethodKind::kInstruction);
  const MethodSummary* teleop = find(MethodKind::kTeleop);
  for (const MethodSummary* baseline : {instruction, teleop}) {
    if (ig_mcts != nullptr && baseline != nullptr) bars.push_back(ImageBar(*ig_mcts, *baseline));
  }
  if (ig_mcts != nullptr && instruction != nullptr) {
    bars.push_back(StepsBar(*ig_mcts, *instruction, 1.05, Bar::Kind::kAtMost));
  }
  if (ig_mcts != nullptr && teleop != nullptr) {
    bars.push_back(StepsBar(*ig_mcts, *teleop, 1.0, Bar::Kind::kBelow));
  }
  bars.push_back(GoalsBar(methods));
  return bars;
}

StudySummary Summarise(const Design& design, const Records& records) {
  StudySummary summary;
  for (const StudyRow& row : design.rows) {
    summary.methods.push_back(SummariseRow(design, records, row));
  }
  const auto ordered = std::span(design.rows).first(design.methods.size());
  for (std::size_t measure = 0; measure < Measures().size(); ++measure) {
    summary.analyses.push_back(AnalyseMeasure(design, records, measure, ordered));
  }
  summary.comparable = CompareSteps(design, records);
  summary.break_even_mps = BreakEvenSpeed(summary.methods);
  summary.bars = CheckBars(summary.methods);
  for (const PlannedEpisode& episode : design.episodes) {
    const EpisodeRecord* record = Find(records, episode.name);
    if (record == nullptr) continue;
    if (record->status == EpisodeStatus::kFailed) summary.failed.push_back(record);
    if (record->status == EpisodeStatus::kGoalsLeft) summary.goals_left.push_back(record);
  }
  return summary;
}

}  // namespace conav::study
