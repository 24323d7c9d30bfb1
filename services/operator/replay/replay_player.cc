#include <algorithm>
#include <cmath>
#include <utility>

#include "operator/console/console_messages.h"
#include "operator/replay/timeline.h"

namespace conav::operators {
namespace {

constexpr double kAgeError = 0.4;        // s; a robot is stale after 1 s
constexpr double kPlaybackPeriod = 0.2;  // s

}  // namespace

struct ReplayPlayer::Play {
  ReplayPlayer& player;
  std::size_t moment;
  double received_s;
  double now_s;

  ConsoleState& state() const { return player.state_; }

  void operator()(const RobotState& robot) const {
    player.states_[robot.robot] = moment;
    state().Receive(robot, received_s);
  }
  void operator()(const SeenMap& seen) const {
    state().ReceiveSeen(seen.robot, seen.world, seen.map);
  }
  void operator()(const InitialMap& map) const { state().ReceiveGeometry(map.world, map.map); }
  void operator()(const TrueMap& truth) const {
    state().ReceiveTruth(truth.world, truth.map.cells);
  }
  void operator()(const ReceivedBelief& received) const {
    state().Receive(received.belief, *received.initial);
  }
  void operator()(const Guidance& guidance) const { state().Receive(guidance); }
  void operator()(const PlannedPath& plan) const {
    state().ReceivePlan(plan.robot, plan.stamp, plan.cells);
  }
  void operator()(const GoalSet& goal) const {
    state().ReceiveGoalPose(goal.robot, goal.cell, goal.stamp.ToSeconds());
  }
  void operator()(const SearchReport& report) const { state().Receive(report); }
  void operator()(const Snapshot& snapshot) const {
    player.snapshots_[snapshot.robot] = moment;
    state().Receive(ToConsole(snapshot, received_s));
    SnapshotStore& store = player.shared_.snapshots;
    const auto kept = store.Find(snapshot.robot, snapshot.sequence_number);
    if (kept && *kept == snapshot.jpeg) return;
    store.Put(snapshot.robot, snapshot.sequence_number, std::vector(snapshot.jpeg));
  }
  void operator()(const SnapshotAnswered& answer) const {
    state().ReceiveAnswer(answer.robot, answer.snapshot, answer.client);
  }
  void operator()(const StreamFrame& stream) const {
    player.frames_[stream.robot] = moment;
    console::Frame frame;
    frame.set_robot(stream.robot);
    frame.set_stamp(stream.stamp.ToSeconds());
    frame.set_received_at(received_s);
    const auto known = player.states_.find(stream.robot);
    if (known != player.states_.end()) {
      const auto& robot = std::get<RobotState>(player.timeline_.moments[known->second].value);
      *frame.mutable_cell() = ToConsole(robot.cell);
      frame.set_heading(robot.heading_rad);
    }
    frame.mutable_jpeg()->assign(stream.jpeg.begin(), stream.jpeg.end());
    player.shared_.frames.Put(std::move(frame));
  }
  void operator()(const AttentionQueueState& queue) const { state().Receive(queue); }
  void operator()(const StopOrder& order) const {
    console::Control control;
    control.set_robot(order.robot);
    control.set_stopped(order.stopped);
    control.set_stopped_by(order.given_by);
    control.set_stop_reason(order.reason);
    state().Receive(std::move(control));
  }
  void operator()(const ServiceHealth& health) const {
    player.processes_[health.name] = moment;
    state().Receive(health, received_s);
  }
  void operator()(Alert alert) const {
    player.alerts_[alert.id] = moment;
    alert.raised_s = player.ReceivedAt(alert.raised_s, now_s);
    alert.newest_s = player.ReceivedAt(alert.newest_s, now_s);
    state().Receive(ToConsole(alert));
  }
  void operator()(const console::Event& event) const { state().Receive(event); }
};

ReplayPlayer::ReplayPlayer(const Timeline& timeline, Shared shared, double now_s)
    : timeline_(timeline), shared_(shared), state_(shared.updates, timeline.session) {
  MoveTo(0.0, now_s);
  PutPlayback(now_s);
}

void ReplayPlayer::Advance(double elapsed_s, double now_s) {
  const UpdateLog::Together together(shared_.updates);
  const double speed = speed_;
  if (speed_ > 0.0) MoveTo(position_s_ + speed_ * elapsed_s, now_s);
  if (position_s_ >= timeline_.duration_s) speed_ = 0.0;
  Refresh(now_s);
  const bool is_due = std::abs(now_s - playback_sent_at_s_) >= kPlaybackPeriod;
  if (speed_ != speed || (speed_ > 0.0 && is_due)) PutPlayback(now_s);
}

void ReplayPlayer::Seek(std::optional<double> position_s, std::optional<double> speed,
                        double now_s) {
  const UpdateLog::Together together(shared_.updates);
  if (speed && std::isfinite(*speed)) speed_ = std::clamp(*speed, 0.0, kFastest);
  if (position_s && std::isfinite(*position_s)) {
    if (*position_s < position_s_) Reset();
    MoveTo(*position_s, now_s);
    Refresh(now_s);
  }
  PutPlayback(now_s);
}

void ReplayPlayer::Receive(std::vector<Person> people) {
  people_ = std::move(people);
  state_.Receive(people_);
}

void ReplayPlayer::Reset() {
  state_.Reset();
  if (!people_.empty()) state_.Receive(people_);
  next_ = 0;
  states_.clear();
  snapshots_.clear();
  frames_.clear();
  processes_.clear();
  alerts_.clear();
}

void ReplayPlayer::MoveTo(double position_s, double now_s) {
  position_s_ = std::clamp(position_s, 0.0, timeline_.duration_s);
  const std::vector<Moment>& moments = timeline_.moments;
  const auto after = std::upper_bound(
      moments.begin() + static_cast<std::ptrdiff_t>(next_), moments.end(), position_s_,
      [](double position, const Moment& moment) { return position < moment.position_s; });
  const auto end = static_cast<std::size_t>(after - moments.begin());
  for (; next_ < end; ++next_) {
    const Moment& moment = moments[next_];
    if (moment.replaced_by < end) continue;
    std::visit(Play{*this, next_, ReceivedAt(moment.position_s, now_s), now_s}, moment.value);
  }
}

void ReplayPlayer::Refresh(double now_s) {
  const double age_zero_s = now_s - position_s_;
  if (std::abs(age_zero_s - age_zero_s_) < kAgeError) return;
  age_zero_s_ = age_zero_s;
  for (const auto* of_kind : {&states_, &processes_, &frames_}) {
    for (const auto& [name, moment] : *of_kind) {
      const Moment& again = timeline_.moments[moment];
      std::visit(Play{*this, moment, ReceivedAt(again.position_s, now_s), now_s}, again.value);
    }
  }
  for (const auto& [robot, moment] : snapshots_) {
    state_.ReceiveSnapshotAgain(robot, ReceivedAt(timeline_.moments[moment].position_s, now_s));
  }
  for (const auto& [id, moment] : alerts_) {
    Play{*this, moment, now_s, now_s}(std::get<Alert>(timeline_.moments[moment].value));
  }
}

void ReplayPlayer::PutPlayback(double now_s) {
  playback_sent_at_s_ = now_s;
  console::Playback playback;
  playback.set_position(position_s_);
  playback.set_duration(timeline_.duration_s);
  playback.set_speed(speed_);
  playback.set_began(timeline_.began_s);
  playback.mutable_marks()->Add(timeline_.marks.begin(), timeline_.marks.end());
  state_.Receive(playback);
}

}  // namespace conav::operators
