#include "operator/supervision/workload.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace conav::operators {

double FanOut(double neglect_s, double interaction_s) {
  return FanOutWithWaits(neglect_s, interaction_s, 0.0);
}

double FanOutWithWaits(double neglect_s, double interaction_s, double wait_s) {
  return interaction_s > 0.0 ? neglect_s / (interaction_s + wait_s) + 1.0 : 0.0;
}

FiniteSourcePrediction PredictFiniteSource(int robots, double neglect_s, double interaction_s) {
  FiniteSourcePrediction prediction;
  prediction.attended = robots;
  if (robots <= 0 || interaction_s <= 0.0) return prediction;
  // P0 = 1 / sum_n N! / (N - n)! (lambda / mu)^n. Divided by its last term, the sum can neither
  // overflow nor need lambda: with x = mu / lambda it is sum_k x^k / k!, k = N - n, and P0 = x^N /
  // N! over it.
  const double x = neglect_s / interaction_s;
  double term = 1.0;  // x^k / k!
  double sum = 0.0;
  for (int k = 0; k < robots; ++k) {
    sum += term;
    term *= x / (k + 1);
  }
  sum += term;
  prediction.idle = term / sum;
  prediction.utilisation = 1.0 - prediction.idle;
  prediction.time_in_system = robots * interaction_s / prediction.utilisation - neglect_s;
  // One robot waits for nobody: what rounding leaves of that may be below 0.
  prediction.waiting_time = std::max(0.0, prediction.time_in_system - interaction_s);
  const double rate = prediction.utilisation / interaction_s;
  prediction.attended = robots - rate * prediction.waiting_time;
  return prediction;
}

namespace {

constexpr std::size_t kHistory = 1000;

double Between(SimTime from, SimTime to) {
  return static_cast<double>(std::max<std::int64_t>(0, to.nanoseconds - from.nanoseconds)) / 1e9;
}

void Keep(std::deque<double>& values, double value) {
  values.push_back(value);
  if (values.size() > kHistory) values.pop_front();
}

double MeanOf(const std::deque<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double MeanOf(const std::map<std::uint64_t, double>& values) {
  if (values.empty()) return 0.0;
  double sum = 0.0;
  for (const auto& [number, value] : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Nearest rank.
double Percentile95(const std::deque<double>& values) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

void WorkloadMeter::Arrived(const AttentionItem& item, SimTime now) {
  waiting_since_[{item.robot, item.reason}] = item.since;
  const auto since = neglect_since_.find(item.robot);
  if (since == neglect_since_.end()) return;
  Keep(neglect_s_, Between(since->second, now));
  neglect_since_.erase(since);
}

void WorkloadMeter::Selected(const std::string& client, const AttentionItem& item, SimTime now) {
  const auto before = open_.find(client);
  if (before != open_.end()) {
    Interaction& open = before->second;
    if (!open.is_over && open.robot == item.robot && open.reason == item.reason) return;
    if (!open.is_over) Close(open, open.last_command.value_or(now));
    open_.erase(before);
  }
  if (!IsQuestion(item.reason)) return;
  EndWait(item, now);
  open_[client] = {item.robot, item.world, item.reason, now};
}

void WorkloadMeter::Accepted(const std::string& client, const std::string& robot_or_world,
                             SimTime now) {
  const auto found = open_.find(client);
  if (found != open_.end()) {
    Interaction& open = found->second;
    const bool belongs = open.robot == robot_or_world || open.world == robot_or_world;
    if (!open.is_over) {
      if (belongs) open.last_command = now;
      return;
    }
    if (belongs && Between(*open.last_command, now) <= options_.linger_s) {
      return Lengthen(client, open, now);
    }
  }
  Work(client, now + Seconds(-options_.linger_s), now);
}

/// What is counted already is not counted again.
void WorkloadMeter::Work(const std::string& client, SimTime start, SimTime now) {
  std::erase_if(worked_to_, [start](const auto& one) { return one.second < start; });
  SimTime& worked_to = worked_to_[client];
  start = std::max({start, worked_to, observed_since_.value_or(now)});
  worked_to = std::max(worked_to, now);
  busy_s_ += Between(start, now);
  if (!busy_spans_.empty() && busy_spans_.back().end == start) {
    busy_spans_.back().end = now;  // a key that is held gives four commands a second
  } else {
    busy_spans_.push_back({start, now});
  }
  while (busy_spans_.size() > kHistory) busy_spans_.pop_front();
}

void WorkloadMeter::Lengthen(const std::string& client, Interaction& interaction, SimTime now) {
  const double later = Between(*interaction.last_command, now);
  const double before = std::exchange(interaction.seconds, interaction.seconds + later);
  times_.Replace(interaction.reason, before, interaction.seconds);
  const auto kept = interaction_s_.find(interaction.number);
  if (kept != interaction_s_.end()) kept->second = interaction.seconds;
  busy_s_ += later;
  busy_spans_.push_back({*interaction.last_command, now});
  interaction.last_command = now;
  worked_to_[client] = now;
}

void WorkloadMeter::Left(const AttentionQueue::Departure& departure) {
  const AttentionItem& item = departure.item;
  if (!IsQuestion(item.reason)) return;
  value_lost_ += item.value_lost_per_s * Between(item.since, departure.at);
  neglect_since_[item.robot] = departure.at;
  if (!departure.answered) ++abandoned_;
  if (!item.selected_by.empty()) waiting_since_.erase({item.robot, item.reason});
  if (item.selected_by.empty()) return EndWait(item, departure.at);
  const auto found = open_.find(item.selected_by);
  if (found == open_.end() || found->second.is_over || !departure.answered) return;
  Interaction& open = found->second;
  if (open.robot != item.robot || open.reason != item.reason) return;
  open.last_command = departure.at;
  Close(open, departure.at);
  open.is_over = true;
  worked_to_[item.selected_by] = departure.at;
}

void WorkloadMeter::Close(Interaction& interaction, SimTime now) {
  busy_s_ += Between(interaction.start, now);
  busy_spans_.push_back({interaction.start, now});
  while (busy_spans_.size() > kHistory) busy_spans_.pop_front();
  interaction.number = ++interactions_;
  if (!interaction.last_command) return;
  interaction.seconds = Between(interaction.start, *interaction.last_command);
  interaction_s_.emplace(interaction.number, interaction.seconds);
  if (interaction_s_.size() > kHistory) interaction_s_.erase(interaction_s_.begin());
  times_.Add(interaction.reason, interaction.seconds);
}

void WorkloadMeter::EndWait(const AttentionItem& item, SimTime now) {
  waiting_since_.erase({item.robot, item.reason});
  Keep(wait_s_, Between(item.since, now));
}

std::deque<double> WorkloadMeter::Waits(SimTime now) const {
  std::deque<double> waits = wait_s_;
  for (const auto& [question, since] : waiting_since_) waits.push_back(Between(since, now));
  return waits;
}

void WorkloadMeter::Advance(std::size_t robots_at_work, std::size_t robots_waiting, SimTime now) {
  if (observed_since_) {
    const double seconds = Between(advanced_to_, now);
    robot_s_ += static_cast<double>(robots_at_work_) * seconds;
    waiting_robot_s_ += static_cast<double>(robots_waiting_) * seconds;
  }
  if (!observed_since_ && robots_at_work > 0) observed_since_ = now;
  robots_at_work_ = robots_at_work;
  robots_waiting_ = robots_waiting;
  advanced_to_ = now;
}

double WorkloadMeter::BusyInWindow(SimTime now) const {
  const SimTime start = std::max(now + Seconds(-options_.window_s), *observed_since_);
  double busy = 0.0;
  for (const Span& span : busy_spans_) busy += Between(std::max(span.start, start), span.end);
  for (const auto& [client, open] : open_) {
    if (!open.is_over) busy += Between(std::max(open.start, start), now);
  }
  return std::min(1.0, busy / std::max(Between(start, now), 1e-9));
}

OperatorWorkload WorkloadMeter::Workload(SimTime now) const {
  OperatorWorkload workload;
  workload.robots = static_cast<std::uint32_t>(robots_at_work_);
  if (!observed_since_) return workload;
  workload.interactions = interactions_;
  workload.abandoned = abandoned_;
  workload.observed_s = Between(*observed_since_, now);
  workload.busy_s = busy_s_;
  for (const auto& [client, open] : open_) {
    if (!open.is_over) workload.busy_s += Between(open.start, now);
  }
  workload.interaction_time_s = MeanOf(interaction_s_);
  workload.neglect_time_s = MeanOf(neglect_s_);
  const std::deque<double> waits = Waits(now);
  workload.waiting_time_s = MeanOf(waits);
  workload.waiting_time_p95_s = Percentile95(waits);
  workload.value_lost = value_lost_;
  workload.utilisation = BusyInWindow(now);
  if (workload.observed_s > 0.0) {
    workload.attended_robots = (robot_s_ - waiting_robot_s_) / workload.observed_s;
  }
  const double neglect_s = workload.neglect_time_s;
  const double interaction_s = workload.interaction_time_s;
  workload.fan_out = FanOut(neglect_s, interaction_s);
  workload.fan_out_with_waits = FanOutWithWaits(neglect_s, interaction_s, workload.waiting_time_s);
  const auto predicted =
      PredictFiniteSource(static_cast<int>(robots_at_work_), neglect_s, interaction_s);
  workload.predicted_utilisation = predicted.utilisation;
  workload.predicted_waiting_time_s = predicted.waiting_time;
  return workload;
}

}  // namespace conav::operators
