#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/runtime/result.h"
#include "operator/supervision/workload.h"
#include "study/statistics/moments.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

using Value = std::optional<double>;

double PerMinute(double value, const SupervisionRecord& record) {
  return record.minutes > 0.0 ? value / record.minutes : 0.0;
}

Value If(bool is_measured, double value) { return is_measured ? Value(value) : std::nullopt; }

bool HasQuestions(const SupervisionRecord& record) {
  return record.workload.interactions + record.workload.abandoned > 0 ||
         record.workload.waiting_time_s > 0.0;
}

bool HasPredictions(const SupervisionRecord& record) {
  return record.workload.neglect_time_s > 0.0 && record.workload.interaction_time_s > 0.0;
}

Value AtMostAll(double fan_out, const SupervisionRecord& record) {
  return If(HasPredictions(record), std::min(fan_out, static_cast<double>(record.trial.robots)));
}

Value Predicted(const SupervisionRecord& record,
                double operators::FiniteSourcePrediction::*figure) {
  if (!HasPredictions(record)) return std::nullopt;
  return operators::PredictFiniteSource(record.trial.robots, record.workload.neglect_time_s,
                                        record.workload.interaction_time_s).*
         figure;
}

std::vector<double> Values(const SupervisionCell& cell, const SupervisionMeasure& measure) {
  std::vector<double> values;
  for (const SupervisionRecord* record : cell.records) {
    if (const Value value = measure.value(*record)) values.push_back(*value);
  }
  return values;
}

const SupervisionRecord* Find(const SupervisionCell& cell, std::uint64_t seed) {
  const auto found = std::ranges::find_if(
      cell.records, [seed](const SupervisionRecord* record) { return record->trial.seed == seed; });
  return found == cell.records.end() ? nullptr : *found;
}

statistics::ConditionTable TableOf(const std::vector<const SupervisionCell*>& cells,
                                   const SupervisionMeasure& measure) {
  statistics::ConditionTable table;
  for (const SupervisionCell* cell : cells) table.conditions.push_back(cell->order);
  for (const SupervisionRecord* record : cells.front()->records) {
    std::vector<double> row;
    for (const SupervisionCell* cell : cells) {
      const SupervisionRecord* same = Find(*cell, record->trial.seed);
      const Value value = same != nullptr ? measure.value(*same) : std::nullopt;
      if (value) row.push_back(*value);
    }
    if (row.size() != cells.size()) continue;
    table.subjects.push_back(std::to_string(record->trial.seed));
    table.values.insert(table.values.end(), row.begin(), row.end());
  }
  return table;
}

SupervisionCell CellOf(int robots, const std::string& order,
                       const std::vector<SupervisionRecord>& records) {
  SupervisionCell cell{robots, order, {}};
  for (const SupervisionRecord& record : records) {
    const bool is_of = record.trial.robots == robots && record.trial.order == order;
    if (is_of && record.is_complete()) cell.records.push_back(&record);
  }
  return cell;
}

/// Empty for fewer than two seeds or orders.
std::vector<SupervisionComparison> CompareOrders(const std::vector<SupervisionCell>& all_cells,
                                                 int robots) {
  std::vector<const SupervisionCell*> cells;
  for (const SupervisionCell& cell : all_cells) {
    if (cell.robots == robots) cells.push_back(&cell);
  }
  std::vector<SupervisionComparison> comparisons;
  for (const char* key : {"goals_per_minute", "value_lost_per_minute", "waiting_s"}) {
    const SupervisionMeasure& measure = FindMeasure(key);
    const statistics::ConditionTable table = TableOf(cells, measure);
    if (table.subject_count() < 2 || cells.size() < 2) continue;
    comparisons.push_back({robots, &measure, statistics::ComparePairs(table, statistics::kAlpha)});
  }
  return comparisons;
}

}  // namespace

const std::vector<SupervisionMeasure>& SupervisionMeasures() {
  using Record = const SupervisionRecord&;
  using Prediction = operators::FiniteSourcePrediction;
  static const std::vector<SupervisionMeasure> measures{
      {"goals_per_minute", "goals/min", "Throughput, goals per minute",
       [](Record r) { return Value(PerMinute(r.goals, r)); }},
      {"waiting_s", "wait s", "Mean waiting time, s",
       [](Record r) { return If(HasQuestions(r), r.workload.waiting_time_s); }},
      {"waiting_p95_s", "wait p95", "Waiting time, 95th percentile, s",
       [](Record r) { return If(HasQuestions(r), r.workload.waiting_time_p95_s); }},
      {"value_lost_per_minute", "lost/min",
       "Value lost while waiting for an answer, reward units per minute",
       [](Record r) { return Value(PerMinute(r.workload.value_lost, r)); }},
      {"abandoned", "unanswered", "Requests without an answer",
       [](Record r) { return Value(static_cast<double>(r.workload.abandoned)); }},
      {"utilisation", "UT", "Utilisation: busy share of the operator's time",
       [](Record r) {
         return If(r.workload.observed_s > 0.0, r.workload.busy_s / r.workload.observed_s);
       }},
      {"interaction_s", "IT s", "Interaction time, s",
       [](Record r) {
         return If(r.workload.interaction_time_s > 0.0, r.workload.interaction_time_s);
       }},
      {"neglect_s", "NT s", "Neglect time, s",
       [](Record r) { return If(r.workload.neglect_time_s > 0.0, r.workload.neglect_time_s); }},
      {"attended_robots", "FO", "Fan-out measured: mean number of robots that do not wait",
       [](Record r) { return If(r.workload.observed_s > 0.0, r.workload.attended_robots); }},
      {"fan_out", "NT/IT+1", "Fan-out predicted, NT / IT + 1",
       [](Record r) { return AtMostAll(r.workload.fan_out, r); }},
      {"fan_out_with_waits", "with waits", "Fan-out predicted, NT / (IT + WT) + 1",
       [](Record r) { return AtMostAll(r.workload.fan_out_with_waits, r); }},
      {"queue_attended_robots", "M/M/1//N", "Fan-out predicted, M/M/1//N",
       [](Record r) { return Predicted(r, &Prediction::attended); }},
      {"queue_utilisation", "UT M/M/1//N", "Utilisation predicted, M/M/1//N",
       [](Record r) { return Predicted(r, &Prediction::utilisation); }},
      {"queue_waiting_s", "wait M/M/1//N", "Waiting time predicted, M/M/1//N, s",
       [](Record r) { return Predicted(r, &Prediction::waiting_time); }},
      {"pace", "pace", "Simulated seconds per second, as a share of --speed",
       [](Record r) { return Value(r.pace); }},
  };
  return measures;
}

const SupervisionMeasure& FindMeasure(const std::string& key) {
  const auto& measures = SupervisionMeasures();
  const auto found = std::ranges::find_if(
      measures, [&](const SupervisionMeasure& measure) { return key == measure.key; });
  DEMAND(found != measures.end(), key);
  return *found;
}

std::optional<double> SupervisionCell::Mean(const SupervisionMeasure& measure) const {
  const std::vector<double> values = Values(*this, measure);
  return values.empty() ? Value() : statistics::Mean(values);
}

std::optional<double> SupervisionCell::HalfInterval(const SupervisionMeasure& measure) const {
  const std::vector<double> values = Values(*this, measure);
  if (values.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(values.size());
  const double error = statistics::StandardDeviation(values) / std::sqrt(count);
  return statistics::StudentInterval(0.0, error, count - 1.0, statistics::kAlpha).high;
}

SupervisionSummary Summarise(const SupervisionOptions& options,
                             const std::vector<SupervisionRecord>& records) {
  SupervisionSummary summary;
  for (const int robots : options.robots) {
    for (const std::string& order : options.orders) {
      summary.cells.push_back(CellOf(robots, order, records));
    }
  }
  for (const SupervisionRecord& record : records) {
    if (record.has_failed()) {
      summary.failed.push_back(&record);
    } else if (record.pace < kLeastPace) {
      summary.slow.push_back(&record);
    }
  }
  for (const int robots : options.robots) {
    auto comparisons = CompareOrders(summary.cells, robots);
    std::ranges::move(comparisons, std::back_inserter(summary.comparisons));
  }
  return summary;
}

}  // namespace conav::study
