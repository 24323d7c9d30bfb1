#include "planner/decision/robot_worker.h"

#include <algorithm>

#include "common/runtime/log.h"
#include "planner/decision/traffic.h"

namespace conav::planner {
namespace {

/// How near to a place the robot is asked to come: a share of a cell's side, and no nearer than
/// this.
constexpr double kToleranceShare = 0.3;
constexpr double kLeastToleranceM = 0.1;
/// A robot's sequence number from which a lease does not count on: the range would end.
constexpr std::uint64_t kFarAhead = std::uint64_t{1} << 63;

}  // namespace

void CommandPublisher::Begin(std::uint64_t lease_epoch) {
  last_ = {};
  last_.lease_epoch = lease_epoch;
}

RobotCommand CommandPublisher::Issue(const Action& action, const RobotState& state, SimTime now) {
  last_.robot = robot_;
  last_.lease_epoch = last_.lease_epoch == 0 ? state.lease_epoch + 1 : last_.lease_epoch;
  const std::uint64_t shown = state.command_sequence_number;
  last_.sequence_number = std::max(last_.sequence_number, shown < kFarAhead ? shown : 0) + 1;
  last_.stamp = now;
  last_.expires_at = action.kind == CommandKind::kDrive ? action.expires_at : now + ttl_;
  last_.kind = action.kind;
  last_.path.clear();
  if (action.kind == CommandKind::kMove) {
    for (const Cell cell : action.route) last_.path.push_back(state.grid.CellToPosition(cell));
    if (action.route.empty()) last_.path.push_back(state.grid.CellToPosition(action.target));
    last_.tolerance_m = std::max(kLeastToleranceM, kToleranceShare * state.grid.cell_size_m);
  }
  last_.heading_rad = action.heading_rad;
  last_.drive = action.drive;
  last_.drive_order = action.drive_order;
  return last_;
}

bool CommandPublisher::IsShownBy(const RobotState& state) const {
  return state.command_sequence_number == last_.sequence_number &&
         state.lease_epoch == last_.lease_epoch;
}

std::optional<RobotCommand> CommandPublisher::Repeat(const RobotState& state, SimTime now) {
  const bool newer = state.lease_epoch == last_.lease_epoch &&
                     state.command_sequence_number > last_.sequence_number;
  if (last_.sequence_number == 0 || IsShownBy(state) || newer) return std::nullopt;
  last_.stamp = now;
  if (last_.kind != CommandKind::kDrive) last_.expires_at = now + ttl_;
  return last_;
}

namespace {

/// Where a route leads the robot; none = it goes to its own goals.
std::optional<Cell> RouteEnd(const RobotInputs& inputs) {
  const bool is_taken = inputs.route_status.stage == RouteStatus::Stage::kTaken;
  if (!is_taken || inputs.guidance->valid_until < inputs.state->stamp) return std::nullopt;
  return inputs.route_status.end;
}

constexpr std::chrono::seconds kIdle{1};
/// Wall time until a command that was not taken up is sent again.
constexpr std::chrono::seconds kCommandRepeat{1};
/// Wall time until a robot that waits for another one looks again.
constexpr std::chrono::milliseconds kWaitRetry{100};
/// Wall time after which a robot that decided to wait decides again in any case.
constexpr std::chrono::seconds kDecideAgain{5};
/// A robot that has been shut in for so long, but for short gaps, insists (MakeRoom()). Both grow with
/// the time that robots need to move.
constexpr std::chrono::seconds kInsistAfter{2};
constexpr std::chrono::seconds kShutInGap{1};
/// Wall time after which a robot that waits for an answer asks again: the question may be lost with the
/// operator's service, with a planner that drove the robot before, or while the robot was silent.
constexpr std::chrono::seconds kAskAgain{10};
/// Time of the robot for which one that refused to send a picture is not asked for another.
constexpr std::chrono::seconds kNoPictures{60};

}  // namespace

RobotWorker::RobotWorker(Options options, std::unique_ptr<Method> method, Blackboard& board,
                         const Clock& clock, Outputs outputs)
    : options_(std::move(options)),
      method_(std::move(method)),
      board_(board),
      clock_(clock),
      outputs_(std::move(outputs)),
      gate_(method_->awaits(), options_.timeouts),
      commands_(options_.robot, options_.command_ttl),
      backoff_(options_.seed) {}

void RobotWorker::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    const std::uint64_t seen = board_.version(options_.robot);
    const Clock::TimePoint again = Step(stop);
    if (again > clock_.Now()) board_.WaitForChange(options_.robot, seen, again);
  }
}

Clock::TimePoint RobotWorker::Step(const StopToken& stop) {
  const Clock::TimePoint now = clock_.Now();
  // Reads the lease together with all else: everything sent below is sent under this lease.
  RobotInputs inputs = board_.Read(options_.robot);
  const BlockedReason reason = CheckInputs(inputs, now);
  const bool operator_is_asked =
      reason == BlockedReason::kFirstGuidance || reason == BlockedReason::kAnswer;
  if (inputs.route && operator_is_asked) {  // a new goal is the answer
    AdoptRoute(inputs);
    return now;
  }
  ReportWaitingRoute(inputs, reason);
  if (reason != BlockedReason::kNothing) return WaitFor(reason, inputs, now);
  AdoptRoute(inputs);
  if (RouteEnd(inputs) == inputs.state->cell) {
    board_.FinishRoute(options_.robot);
    return now;
  }
  const Situation situation = SituationFrom(inputs);
  const bool waits = waiting_for_guidance_ && newest_revision_ == waiting_for_other_than_;
  // A robot that asked for a new path will hardly go on along the old one.
  const std::vector<Cell> path = waits ? std::vector<Cell>{} : method_->IntendedPathFor(situation);
  const Traffic traffic = method_->is_steered() ? Traffic::kGoOn : GiveWay(situation, path);
  if (traffic == Traffic::kStepAside) {
    backoff_.MakesRoom(now, std::max<std::chrono::nanoseconds>(kWaitRetry, pace_));
    return now;
  }
  if (traffic == Traffic::kWait) return now + kWaitRetry;
  if (now < backoff_.until()) return backoff_.until();
  if (waits) return now + kIdle;
  if (IsNewlyOccupied(situation.state)) return now + kWaitRetry;
  waiting_for_guidance_ = false;
  if (inputs.causes == waited_at_ && now < decide_again_) return LookAgain(now);
  decide_again_ = now + kDecideAgain;
  waited_at_ = inputs.causes;
  return Decide(situation, inputs.lease, stop, now);
}

BlockedReason RobotWorker::CheckInputs(const RobotInputs& inputs, Clock::TimePoint now) {
  AdoptLease(inputs.lease);
  const BlockedReason reason =
      gate_.Check(inputs, commands_.sent_sequence_number(), commands_.lease_epoch(), GateTime(now));
  if (gate_.TakeTimedOut()) {
    LOG_WARNING("operator does not answer, going on alone", "robot", options_.robot, "snapshot",
                inputs.state->snapshots);
    WithdrawRequest(*inputs.state);
  }
  if (reason != blocked_) ReportBlocked(reason, inputs);
  if (blocked_ == BlockedReason::kCommand && reason != blocked_) pace_ = now - command_sent_at_;
  blocked_ = reason;
  board_.PutBlockedReason(options_.robot, Name(reason));
  if (reason != BlockedReason::kNoLease && inputs.state) ReportOutcome(*inputs.state);
  return reason;
}

Clock::TimePoint RobotWorker::GateTime(Clock::TimePoint now) const {
  if (!options_.timeouts_in_simulation_time) return now;
  return Clock::TimePoint(std::chrono::nanoseconds(board_.NewestStamp(options_.robot).nanoseconds));
}

Clock::TimePoint RobotWorker::Decide(const Situation& situation, const Lease& lease,
                                     const StopToken& stop, Clock::TimePoint now) {
  const auto start = std::chrono::steady_clock::now();
  Decision decision = method_->Decide(situation, stop);
  const std::chrono::duration<double, std::milli> duration =
      std::chrono::steady_clock::now() - start;
  if (stop.stop_requested() || !StillHolds(lease)) return now;
  if (outputs_.timed) outputs_.timed(duration.count());
  const bool acts = decision.action.has_value();
  if (acts) backoff_.Moves();
  decide_again_ = acts ? now : std::max(now + kWaitRetry, std::min(decide_again_, decision.again));
  Publish(std::move(decision), situation, duration.count());
  return acts ? now : LookAgain(now);
}

Clock::TimePoint RobotWorker::LookAgain(Clock::TimePoint now) const {
  return is_shut_in_ ? std::min(decide_again_, now + kWaitRetry) : decide_again_;
}

void RobotWorker::AdoptLease(const Lease& lease) {
  if (lease.state == Lease::State::kNone || lease.epoch == lease_epoch_) return;
  lease_epoch_ = lease.epoch;
  commands_.Begin(lease.epoch);
  waiting_for_guidance_ = false;
  intended_path_published_ = false;
  question_.reset();
}

bool RobotWorker::StillHolds(const Lease& lease) const {
  const Lease now = board_.LeaseOf(options_.robot);
  return now.state != Lease::State::kNone && now.epoch == lease.epoch;
}

void RobotWorker::SetIntendedPath(std::vector<Cell> path, RoomClaim room) {
  const bool changed = board_.PutIntendedPath(options_.robot, path, room);
  if ((changed || !intended_path_published_) && outputs_.intended_path) {
    outputs_.intended_path({options_.robot, std::move(path), std::move(room)});
  }
  intended_path_published_ = true;
}

RobotWorker::Traffic RobotWorker::GiveWay(const Situation& situation,
                                          const std::vector<Cell>& own_path) {
  const Clock::TimePoint now = clock_.Now();
  if (now - shut_in_at_ > kShutInGap + 2 * pace_) shut_in_since_ = now;
  RoomClaim room = MakeRoom(situation, own_path, now - shut_in_since_ >= kInsistAfter + 2 * pace_);
  is_shut_in_ = room.right.tier == RightOfWay::kShutIn && room.right.robot == options_.robot;
  if (is_shut_in_) shut_in_at_ = now;
  SetIntendedPath(own_path, room);
  if (room.cells.empty()) return Traffic::kGoOn;
  const Cell next = room.cells.front();
  if (!StandsOn(situation, next)) {
    if (outputs_.timed) outputs_.timed(0.0);
    Publish(MoveAlong({next}), situation, 0.0);
    return Traffic::kStepAside;
  }
  return room.right.tier == RightOfWay::kShutIn ? Traffic::kWait : Traffic::kGoOn;
}

Clock::TimePoint RobotWorker::WaitFor(BlockedReason reason, const RobotInputs& inputs,
                                      Clock::TimePoint now) {
  if (reason == BlockedReason::kRelease) {
    board_.GiveUp(options_.robot, inputs.lease);
    return now;
  }
  // The planner that drives the robot publishes its intended path.
  if (reason == BlockedReason::kNoLease || reason == BlockedReason::kLeaseLost) return now + kIdle;
  if (reason == BlockedReason::kCommand) {
    RepeatCommand(inputs, now);
    if (inputs.map) method_->Prepare(inputs.map->cells);
  }
  const bool operator_is_asked =
      reason == BlockedReason::kFirstGuidance || reason == BlockedReason::kAnswer;
  if (operator_is_asked) {
    const Situation situation = SituationFrom(inputs);
    if (reason == BlockedReason::kAnswer) AskAgain(situation, now);
    const Traffic traffic = GiveWay(situation, {});
    if (traffic == Traffic::kStepAside) return now;
    if (is_shut_in_) return now + kWaitRetry;
  } else if (reason != BlockedReason::kCommand && reason != BlockedReason::kMap) {
    // A robot that stands for longer intends no path. (A command or a missing map lasts a moment.)
    SetIntendedPath({}, {});
  }
  return now + kIdle;
}

void RobotWorker::ReportBlocked(BlockedReason reason, const RobotInputs& inputs) const {
  if (reason == BlockedReason::kLeaseLost) {
    LOG_WARNING("another planner took the robot over", "robot", options_.robot, "its_epoch",
                inputs.state->lease_epoch, "our_epoch", commands_.lease_epoch());
  }
  if (reason == BlockedReason::kStopped) {
    const StopOrder order = inputs.stop_order.value_or(StopOrder{});
    LOG_INFO("stopped", "robot", options_.robot, "by", order.given_by, "reason", order.reason);
  }
  if (reason == BlockedReason::kCamera) {
    LOG_INFO("waiting for the camera info", "robot", options_.robot);
  }
  if (reason == BlockedReason::kInconsistent) {
    LOG_ERROR("inputs do not belong together, the robot is not driven", "robot", options_.robot,
              "reason", Inconsistency(inputs).value_or(""));
  }
}

void RobotWorker::ReportOutcome(const RobotState& state) {
  if (state.command_outcome == CommandOutcome::kRunning || !commands_.IsShownBy(state) ||
      state.command_sequence_number == reported_sequence_number_) {
    return;
  }
  reported_sequence_number_ = state.command_sequence_number;
  // Meeting walls and other robots is a normal part of exploring.
  const bool expired = state.command_outcome == CommandOutcome::kExpired;
  if (!expired && state.command_outcome != CommandOutcome::kRefused) return;
  LOG_WARNING(expired ? "command expired" : "command refused", "robot", options_.robot, "sequence",
              state.command_sequence_number, "reason", state.command_detail);
  if (!expired && state.command_sequence_number == view_sequence_number_) {
    pictures_again_at_ = state.stamp + kNoPictures;
  }
}

bool RobotWorker::IsNewlyOccupied(const RobotState& state) {
  if (state.command_outcome != CommandOutcome::kOccupied ||
      state.command_sequence_number == occupied_sequence_number_) {
    return false;
  }
  occupied_sequence_number_ = state.command_sequence_number;
  return true;
}

void RobotWorker::RepeatCommand(const RobotInputs& inputs, Clock::TimePoint now) {
  if (now - command_sent_at_ < kCommandRepeat) return;
  const auto command = commands_.Repeat(*inputs.state, board_.NewestStamp(options_.robot));
  if (!command) return;
  LOG_WARNING("command not taken up, sent again", "robot", options_.robot, "sequence",
              command->sequence_number, "robot_shows", inputs.state->command_sequence_number);
  command_sent_at_ = now;
  outputs_.command(*command);
}

void RobotWorker::AdoptRoute(RobotInputs& inputs) {
  if (!inputs.route) return;
  const Route route = *inputs.route;
  // A robot that keeps no goals gets this one as its goal, from the operator service.
  if (route.positions.size() == 1 && inputs.state->goals_stamp == SimTime{}) {
    return board_.ResolveRoute(options_.robot, route.number,
                               Fail(ErrorCode::kRefused, "the operator service keeps its goals"));
  }
  Result<Guidance> guidance = Fail(ErrorCode::kRefused, "its method follows no paths");
  if (method_->awaits() >= AwaitedInput::kGuidance) {
    guidance =
        GuidanceAlong(route.positions, *inputs.state, *inputs.map, *inputs.belief, inputs.guidance);
  }
  board_.ResolveRoute(options_.robot, route.number, guidance);
  inputs.route_status = board_.RouteStatusOf(options_.robot);
  if (!guidance) {
    LOG_WARNING("goal refused", "robot", options_.robot, "reason", guidance.error().text);
    return;
  }
  LOG_INFO("goal taken as guidance", "robot", options_.robot, "cells", guidance->path.size());
  inputs.guidance = *guidance;
  waiting_for_guidance_ = false;
  WithdrawRequest(*inputs.state);
}

void RobotWorker::ReportWaitingRoute(const RobotInputs& inputs, BlockedReason reason) {
  const bool lasts = reason != BlockedReason::kNothing && reason != BlockedReason::kCommand &&
                     reason != BlockedReason::kMap && reason != BlockedReason::kNoLease;
  if (!lasts || !inputs.route || inputs.route->number == waiting_route_) return;
  waiting_route_ = inputs.route->number;
  LOG_WARNING("goal waits", "robot", options_.robot, "for", Name(reason));
}

Situation RobotWorker::SituationFrom(const RobotInputs& inputs) {
  Situation situation{.state = *inputs.state,
                      .map = *inputs.map,
                      .belief = inputs.belief.value_or(Belief{}),
                      .lens = inputs.lens.value_or(CameraLens{}),
                      .guidance = std::nullopt,
                      .drive = inputs.drive,
                      .now = board_.NewestStamp(options_.robot),
                      .truth = inputs.truth,
                      .neighbours = board_.NeighboursOf(options_.robot)};
  newest_revision_ = inputs.guidance ? inputs.guidance->revision : 0;
  if (inputs.guidance) {
    situation.answered_snapshot = inputs.guidance->answers_snapshot;
    situation.answered_belief = inputs.guidance->belief_revision;
  }
  if (inputs.guidance && !inputs.guidance->path.empty()) {
    guided_before_ = true;
    if (inputs.guidance->valid_until >= situation.state.stamp) situation.guidance = inputs.guidance;
  }
  situation.guided_before = guided_before_;
  situation.sends_no_pictures = situation.state.stamp < pictures_again_at_;
  if (const auto end = RouteEnd(inputs)) situation.state.goals_left = {*end};
  LimitKnowledge(situation, options_.goal_knowledge);
  return situation;
}

void RobotWorker::Publish(Decision decision, const Situation& situation, double duration_ms) {
  const RobotState& state = situation.state;
  if (decision.action) {
    const RobotCommand command =
        commands_.Issue(*decision.action, state, board_.NewestStamp(options_.robot));
    SearchReport& report = decision.report;
    report.stamp = state.stamp;
    report.world = state.world;
    report.robot = state.robot;
    report.method = options_.method_name;
    report.decision = command.sequence_number;  // goes on when another process takes over
    report.cell = state.cell;
    report.belief_revision = situation.belief.revision;
    report.guidance_revision = situation.guidance ? situation.guidance->revision : 0;
    report.duration_ms = duration_ms;
    outputs_.report(report);
    if (!method_->is_steered()) outputs_.plan(state, situation.map, decision.plan);
    command_sent_at_ = clock_.Now();
    if (command.kind == CommandKind::kTransmitView) {
      view_sequence_number_ = command.sequence_number;
    }
    outputs_.command(command);
    if (outputs_.decided) outputs_.decided(decision, situation);
  }
  if (decision.attention) Ask(decision, situation);
}

AttentionRequest RobotWorker::NextRequest(const RobotState& state) {
  AttentionRequest request;
  request.stamp = state.stamp;
  request.world = state.world;
  request.robot = state.robot;
  request.sequence_number = board_.NextAttention(options_.robot);
  request.cell = state.cell;
  request.newest_snapshot = state.snapshots;
  return request;
}

void RobotWorker::Ask(const Decision& decision, const Situation& situation) {
  AttentionRequest request = NextRequest(situation.state);
  request.reason = *decision.attention;
  request.cell = decision.attention_cell;
  request.expected_information = decision.expected_information;
  Ask(std::move(request), decision.answer_value, situation);
  if (decision.action) return;
  waiting_for_guidance_ = true;
  waiting_for_other_than_ = newest_revision_;
}

void RobotWorker::Ask(AttentionRequest request, double answer_value, const Situation& situation) {
  ValueLostOptions value_lost = options_.value_lost;
  if (request.reason == AttentionReason::kSnapshot && method_->awaits() == AwaitedInput::kAnswers) {
    value_lost.answer_timeout_s = std::chrono::duration<double>(options_.timeouts.answer).count();
    if (options_.timeouts_in_simulation_time) {
      request.gives_up_at = request.stamp + options_.timeouts.answer;
    } else {
      request.gives_up_after_s = value_lost.answer_timeout_s;
    }
  }
  request.value_lost_per_s = ValueLostPerSecond(situation, answer_value, value_lost);
  outputs_.attention(request);
  question_ = std::move(request);
  asked_at_ = clock_.Now();
}

void RobotWorker::AskAgain(const Situation& situation, Clock::TimePoint now) {
  const std::uint64_t before_picture = situation.state.snapshots - 1;
  const bool asked = question_ && question_->reason == AttentionReason::kSnapshot &&
                     question_->newest_snapshot == before_picture;
  if (asked && now < asked_at_ + kAskAgain) return;
  AttentionRequest request = NextRequest(situation.state);
  if (!asked) {  // what the answer is worth, the planner before knew
    request.reason = AttentionReason::kSnapshot;
    request.newest_snapshot = before_picture;
    return Ask(std::move(request), 0.0, situation);
  }
  question_->stamp = request.stamp;
  question_->sequence_number = request.sequence_number;
  outputs_.attention(*question_);
  asked_at_ = now;
}

void RobotWorker::WithdrawRequest(const RobotState& state) {
  AttentionRequest request = NextRequest(state);
  request.reason = AttentionReason::kNone;
  outputs_.attention(request);
}

}  // namespace conav::planner
