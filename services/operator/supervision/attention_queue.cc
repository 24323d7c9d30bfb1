#include "operator/supervision/attention_queue.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/runtime/clock.h"
#include "common/runtime/config.h"

namespace conav::operators {

double InteractionPriors::MedianOf(AttentionReason reason) const {
  switch (reason) {
    case AttentionReason::kSnapshot:
      return picture_s;
    case AttentionReason::kBlocked:
      return blocked_s;
    case AttentionReason::kNoGuidance:
    case AttentionReason::kFirstPath:
      return path_s;
    default:
      return notice_s;
  }
}

void InteractionPriors::Visit(ConfigReader& reader) {
  reader.Field("picture_s", picture_s, 0.01, 3600.0);
  reader.Field("blocked_s", blocked_s, 0.01, 3600.0);
  reader.Field("path_s", path_s, 0.01, 3600.0);
  reader.Field("notice_s", notice_s, 0.01, 3600.0);
  reader.Field("log_sd", log_sd, 0.0, 5.0);
  reader.Field("weight", weight, 0.01, 1000.0);
}

void AttentionOptions::Visit(ConfigReader& reader) {
  reader.Choice("order", order, AttentionOrders());
  reader.Field("hysteresis_factor", hysteresis_factor, 1.0, 1000.0);
  reader.Field("dwell_s", dwell_s, 0.0, 3600.0);
  reader.Field("default_deadline_s", default_deadline_s, 0.0, 1e6);
  reader.Field("default_value_lost_per_s", default_value_lost_per_s, 0.0, 1e6);
  reader.Field("notice_s", notice_s, 0.0, 3600.0);
  reader.Field("window_s", window_s, 1.0, 1e6);
  reader.Field("linger_s", linger_s, 0.0, 3600.0);
  reader.Section("priors", priors);
}

namespace {

std::int64_t DeadlineOf(const AttentionItem& item, const AttentionOptions& options) {
  if (item.deadline.nanoseconds > 0) return item.deadline.nanoseconds;
  if (item.gives_up_after_s > 0.0) {
    return (item.since + Seconds(item.gives_up_after_s)).nanoseconds;
  }
  if (!IsQuestion(item.reason)) return std::numeric_limits<std::int64_t>::max();
  return (item.since + Seconds(options.default_deadline_s)).nanoseconds;
}

auto AgeKey(const AttentionItem& item) {
  return std::tie(item.since, item.world, item.robot, item.reason);
}

}  // namespace

const std::vector<std::string>& AttentionOrders() {
  static const std::vector<std::string> orders{"priority", "fifo", "nearest_deadline"};
  return orders;
}

std::uint8_t TierOf(AttentionReason reason) {
  switch (reason) {
    case AttentionReason::kCommandFailed:
      return 1;
    case AttentionReason::kLinkLost:
      return 2;
    case AttentionReason::kBlocked:
    case AttentionReason::kNoGuidance:
    case AttentionReason::kFirstPath:
      return 3;
    case AttentionReason::kSnapshot:
      return 4;
    default:
      return 5;
  }
}

bool IsQuestion(AttentionReason reason) {
  return reason == AttentionReason::kSnapshot || TierOf(reason) == 3;
}

namespace {

bool ComesBefore(const AttentionItem& a, const AttentionItem& b, const AttentionOptions& options) {
  if (options.order == "priority") {
    if (a.tier != b.tier) return a.tier < b.tier;
    if (a.score != b.score) return a.score > b.score;
  } else if (options.order == "nearest_deadline") {
    const auto deadline_a = DeadlineOf(a, options);
    const auto deadline_b = DeadlineOf(b, options);
    if (deadline_a != deadline_b) return deadline_a < deadline_b;
  }
  return AgeKey(a) < AgeKey(b);
}

constexpr double kLeast = 1.0e-3;  // s

double LogOf(double seconds) { return std::log(std::max(seconds, kLeast)); }

}  // namespace

void InteractionTimes::Add(AttentionReason reason, double seconds) {
  Sums& sums = sums_[reason];
  const double log = LogOf(seconds);
  sums.count += 1.0;
  sums.logs += log;
  sums.squares += log * log;
}

void InteractionTimes::Replace(AttentionReason reason, double before_s, double now_s) {
  Sums& sums = sums_[reason];
  const double before = LogOf(before_s);
  sums.count -= 1.0;
  sums.logs -= before;
  sums.squares -= before * before;
  Add(reason, now_s);
}

double InteractionTimes::Expected(AttentionReason reason) const {
  const auto found = sums_.find(reason);
  const Sums measured = found == sums_.end() ? Sums{} : found->second;
  const double prior_log = LogOf(priors_.MedianOf(reason));
  const double count = priors_.weight + measured.count;
  const double mean = (priors_.weight * prior_log + measured.logs) / count;
  const double squares =
      priors_.weight * (priors_.log_sd * priors_.log_sd + prior_log * prior_log) + measured.squares;
  const double variance = std::max(0.0, squares / count - mean * mean);
  return std::exp(mean + variance / 2.0);
}

namespace {

/// Robots say themselves when they go on unanswered, a little after the deadline that they stated;
/// this is for those that do not.
constexpr std::chrono::seconds kDeadlineGrace{10};

bool IsNotice(AttentionReason reason) {
  return reason == AttentionReason::kLinkLost || reason == AttentionReason::kGoalsReached;
}

/// The picture that was asked about is the one after the newest that the robot had sent by then.
std::uint64_t SnapshotOf(const AttentionRequest& request) {
  return request.newest_snapshot + (request.reason == AttentionReason::kSnapshot ? 1 : 0);
}

AttentionItem ItemOf(const AttentionRequest& request, SimTime now) {
  AttentionItem item;
  item.world = request.world;
  item.robot = request.robot;
  item.reason = request.reason;
  item.since = now;
  if (request.gives_up_at.nanoseconds > 0) {  // its world's clock need not be the operator's
    item.deadline = {now.nanoseconds + request.gives_up_at.nanoseconds - request.stamp.nanoseconds};
  }
  item.gives_up_after_s = request.gives_up_after_s;
  item.cell = request.cell;
  item.newest_snapshot = SnapshotOf(request);
  item.source_sequence = request.sequence_number;
  item.value_lost_per_s = request.value_lost_per_s;
  item.expected_information = request.expected_information;
  return item;
}

AttentionItem FoundItem(const RobotState& state, AttentionReason reason, double value_lost_per_s,
                        SimTime now) {
  AttentionItem item;
  item.world = state.world;
  item.robot = state.robot;
  item.reason = reason;
  item.since = now;
  item.cell = state.cell;
  item.newest_snapshot = state.snapshots;
  item.value_lost_per_s = value_lost_per_s;
  return item;
}

}  // namespace

AttentionItem* AttentionQueue::Find(const std::string& robot, AttentionReason reason) {
  const auto found = std::find_if(items_.begin(), items_.end(), [&](const AttentionItem& item) {
    return item.robot == robot && item.reason == reason;
  });
  return found == items_.end() ? nullptr : &*found;
}

void AttentionQueue::Put(AttentionItem item, SimTime now) {
  item.tier = TierOf(item.reason);
  if (AttentionItem* before = Find(item.robot, item.reason)) {
    item.since = before->since;
    item.selected_by = before->selected_by;
    *before = std::move(item);
    return;
  }
  item.since = now;
  if (IsQuestion(item.reason)) arrivals_.push_back(item);
  items_.push_back(std::move(item));
}

void AttentionQueue::Receive(const AttentionRequest& request, SimTime now) {
  const auto robot = robots_.find(request.robot);
  const bool is_at_work = robot != robots_.end() && robot->second.linked && robot->second.has_goals;
  if (request.reason == AttentionReason::kNone) {
    Remove(false, now, [&](const AttentionItem& item) {
      return item.robot == request.robot && item.source_sequence > 0 &&
             item.source_sequence <= request.sequence_number;
    });
  } else if (is_at_work && !IsKnown(request)) {
    Put(ItemOf(request, now), now);
  }
}

bool AttentionQueue::IsKnown(const AttentionRequest& request) {
  if (request.reason != AttentionReason::kSnapshot) return false;
  const AttentionItem item = ItemOf(request, {});
  if (item.newest_snapshot <= robots_[request.robot].answered) return true;
  const AttentionItem* before = Find(request.robot, request.reason);
  return before != nullptr && before->newest_snapshot == item.newest_snapshot &&
         before->cell == item.cell && before->value_lost_per_s == item.value_lost_per_s &&
         before->expected_information == item.expected_information;
}

void AttentionQueue::Receive(const RobotState& state, SimTime now) {
  Robot& robot = robots_[state.robot];
  // A robot in the field may have goals that nobody has given yet.
  const bool searches =
      state.goals_stamp == SimTime{} && state.goals_reached.size() < state.goals_total;
  const bool had_goals = std::exchange(robot.has_goals, searches || !state.goals_left.empty());
  robot.world = state.world;
  robot.linked = true;
  Remove(false, now, [&](const AttentionItem& item) {
    return item.robot == state.robot && item.reason == AttentionReason::kLinkLost;
  });
  const double value = options_.default_value_lost_per_s;
  const bool failed = state.command_outcome == CommandOutcome::kRefused ||
                      state.command_outcome == CommandOutcome::kExpired;
  const AttentionItem* failure = Find(state.robot, AttentionReason::kCommandFailed);
  if (failed && robot.has_goals && robot.failed_command != state.command_sequence_number) {
    robot.failed_command = state.command_sequence_number;
    Put(FoundItem(state, AttentionReason::kCommandFailed, value, now), now);
  } else if (!failed && failure != nullptr) {
    Remove(false, now, [&](const AttentionItem& item) { return &item == failure; });
  }
  if (state.drive_order > 0 && !std::exchange(robot.guided, true)) {
    Remove(true, now, [&](const AttentionItem& item) {
      return item.robot == state.robot && item.reason == AttentionReason::kFirstPath;
    });
  }
  if (robot.has_goals && !robot.guided) {
    Put(FoundItem(state, AttentionReason::kFirstPath, value, now), now);
  }
  if (robot.has_goals) return;
  RemoveQuestions(state.robot, now);
  if (had_goals) Put(FoundItem(state, AttentionReason::kGoalsReached, 0.0, now), now);
}

template <class Leaves>
void AttentionQueue::Remove(bool answered, SimTime now, Leaves&& leaves) {
  std::vector<AttentionItem> kept;
  for (AttentionItem& item : items_) {
    if (leaves(item)) {
      departures_.push_back({std::move(item), now, answered});
    } else {
      kept.push_back(std::move(item));
    }
  }
  items_ = std::move(kept);
}

void AttentionQueue::RemoveQuestions(const std::string& robot, SimTime now) {
  Remove(false, now,
         [&](const AttentionItem& item) { return item.robot == robot && !IsNotice(item.reason); });
}

void AttentionQueue::Receive(const Guidance& guidance, SimTime now) {
  Robot& robot = robots_[guidance.robot];
  const bool answers = guidance.answers_snapshot > robot.answered;
  robot.answered = guidance.answers_snapshot;
  if (guidance.path.empty() && !answers) return;
  robot.guided = true;
  Remove(true, now, [&](const AttentionItem& item) {
    if (item.robot != guidance.robot || !IsQuestion(item.reason)) return false;
    return item.reason != AttentionReason::kSnapshot ||
           item.newest_snapshot <= guidance.answers_snapshot;
  });
}

void AttentionQueue::LoseLink(const std::string& name, SimTime now) {
  const auto robot = robots_.find(name);
  if (robot == robots_.end() || !robot->second.linked) return;
  robot->second.linked = false;
  RemoveQuestions(name, now);
  if (!robot->second.has_goals) return;
  AttentionItem item;
  item.world = robot->second.world;
  item.robot = name;
  item.reason = AttentionReason::kLinkLost;
  item.value_lost_per_s = options_.default_value_lost_per_s;
  Put(std::move(item), now);
}

void AttentionQueue::LosePlanner(const std::string& robot, SimTime now) {
  Remove(false, now, [&](const AttentionItem& item) {
    return item.robot == robot && item.source_sequence > 0;
  });
}

Result<AttentionItem> AttentionQueue::Select(const std::string& client, const SelectRequest& select,
                                             SimTime now) {
  AttentionItem* item = Find(select.robot, select.reason);
  if (item == nullptr) {
    return Fail(ErrorCode::kRefused,
                fmt::format("robot '{}' no longer asks for that", select.robot));
  }
  if (!item->selected_by.empty() && item->selected_by != client) {
    return Fail(ErrorCode::kRefused, fmt::format("{} already works on the request of robot '{}'",
                                                 item->selected_by, select.robot));
  }
  for (AttentionItem& other : items_) {
    if (other.selected_by == client) other.selected_by.clear();
  }
  item->selected_by = client;
  AttentionItem selected = *item;
  if (IsNotice(selected.reason)) {
    Remove(true, now, [item](const AttentionItem& other) { return &other == item; });
  }
  return selected;
}

void AttentionQueue::Update(const InteractionTimes& times, SimTime now) {
  Remove(false, now, [&](const AttentionItem& item) {
    const bool notice_is_over =
        IsNotice(item.reason) && now >= item.since + Seconds(options_.notice_s);
    const bool gave_up = item.deadline.nanoseconds > 0 && now > item.deadline + kDeadlineGrace;
    return notice_is_over || gave_up;
  });
  for (AttentionItem& item : items_) {
    item.expected_interaction_s = times.Expected(item.reason);
    item.score = item.value_lost_per_s / item.expected_interaction_s;
  }
  std::sort(items_.begin(), items_.end(), [&](const AttentionItem& a, const AttentionItem& b) {
    return ComesBefore(a, b, options_);
  });
  KeepFirst(now);
}

void AttentionQueue::KeepFirst(SimTime now) {
  if (items_.empty()) return first_.reset();
  const AttentionItem& best = items_.front();
  const auto before = std::find_if(items_.begin(), items_.end(), [&](const AttentionItem& item) {
    return first_ == std::pair(item.robot, item.reason);
  });
  if (before == items_.begin()) return;
  const bool stays = options_.order == "priority" && before != items_.end() &&
                     before->tier == best.tier && now < first_since_ + Seconds(options_.dwell_s) &&
                     best.score < before->score * options_.hysteresis_factor;
  if (stays) {
    std::rotate(items_.begin(), before, before + 1);
  } else {
    first_ = {best.robot, best.reason};
    first_since_ = now;
  }
}

std::size_t AttentionQueue::robots_at_work() const {
  return static_cast<std::size_t>(std::count_if(robots_.begin(), robots_.end(), [](const auto& r) {
    return r.second.linked && r.second.has_goals;
  }));
}

std::size_t AttentionQueue::robots_waiting() const {
  return static_cast<std::size_t>(
      std::count_if(robots_.begin(), robots_.end(), [this](const auto& robot) {
        const auto asks = [&](bool selected) {
          return std::any_of(items_.begin(), items_.end(), [&](const AttentionItem& item) {
            return item.robot == robot.first && IsQuestion(item.reason) &&
                   item.selected_by.empty() != selected;
          });
        };
        return asks(false) && !asks(true);
      }));
}

}  // namespace conav::operators
