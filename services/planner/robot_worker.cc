#include "planner/robot_worker.h"

#include <chrono>

#include "common/grid/geometry.h"
#include "common/runtime/log.h"
#include "planner/goal_pose.h"

namespace conav::planner {
namespace {

constexpr std::chrono::seconds kIdle{1};

}  // namespace

RobotWorker::RobotWorker(Options options, std::unique_ptr<Method> method, Blackboard& board,
                         const Clock& clock, Outputs outputs)
    : options_(std::move(options)),
      method_(std::move(method)),
      board_(board),
      clock_(clock),
      outputs_(std::move(outputs)),
      gate_(options_.gate),
      desk_(options_.robot, options_.command_ttl) {}

void RobotWorker::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    const std::uint64_t seen = board_.version();
    const Clock::TimePoint again = Step();
    if (again > clock_.Now()) board_.WaitForChange(seen, again);
  }
}

Clock::TimePoint RobotWorker::Step() {
  RobotInputs inputs = board_.Read(options_.robot);
  const Clock::TimePoint now = clock_.Now();
  const Hold hold = gate_.Check(inputs, desk_.sent_sequence_number(), desk_.lease_epoch(), now);
  if (gate_.TakeTimedOut()) {
    LOG_WARNING("operator does not answer, going on alone", "robot", options_.robot, "snapshot",
                inputs.state->snapshots);
  }
  if (hold != Hold::kNothing) return WaitFor(hold, inputs, now);
  hold_ = hold;
  AdoptGoalPose(inputs);
  const std::uint64_t revision = inputs.guidance ? inputs.guidance->revision : 0;
  if (waiting_for_guidance_ && revision <= waiting_beyond_revision_) return now + kIdle;
  waiting_for_guidance_ = false;

  const Situation situation = SituationFrom(inputs);
  board_.PutWay(options_.robot, method_->WayFor(situation));
  const auto start = std::chrono::steady_clock::now();
  Decision decision = method_->Decide(situation);
  const std::chrono::duration<double, std::milli> duration =
      std::chrono::steady_clock::now() - start;
  const bool acts = decision.action.has_value();
  Publish(std::move(decision), situation, duration.count());
  return acts ? now : now + options_.wait_retry;
}

Clock::TimePoint RobotWorker::WaitFor(Hold hold, const RobotInputs& inputs, Clock::TimePoint now) {
  if (hold == Hold::kLeaseLost && hold_ != hold) {
    LOG_WARNING("another planner took the robot over", "robot", options_.robot, "its_epoch",
                inputs.state->lease_epoch, "our_epoch", desk_.lease_epoch());
  }
  hold_ = hold;
  if (hold == Hold::kCommand) RepeatCommand(inputs, now);
  return now + std::min<std::chrono::nanoseconds>(kIdle, options_.command_repeat);
}

void RobotWorker::RepeatCommand(const RobotInputs& inputs, Clock::TimePoint now) {
  if (now - command_sent_at_ < options_.command_repeat) return;
  const auto command = desk_.Repeat(*inputs.state, board_.NewestStamp(options_.robot));
  if (!command) return;
  LOG_WARNING("command not taken up, sent again", "robot", options_.robot, "sequence",
              command->sequence_number, "robot_shows", inputs.state->command_sequence_number);
  command_sent_at_ = now;
  outputs_.command(*command);
}

void RobotWorker::AdoptGoalPose(RobotInputs& inputs) {
  if (!inputs.goal_pose) return;
  auto guidance = GuidanceTowards(*inputs.goal_pose, *inputs.state, *inputs.map, *inputs.belief,
                                  inputs.guidance);
  if (guidance) {
    LOG_INFO("goal pose taken as guidance", "robot", options_.robot, "cells",
             guidance->path.size());
    inputs.guidance = *guidance;
    waiting_for_guidance_ = false;
    board_.ResolveGoalPose(options_.robot, *std::move(guidance));
  } else {
    LOG_WARNING("goal pose refused", "robot", options_.robot, "reason", guidance.error().text);
    board_.ResolveGoalPose(options_.robot, std::nullopt);
  }
}

Situation RobotWorker::SituationFrom(const RobotInputs& inputs) {
  Situation situation{.state = *inputs.state,
                      .map = *inputs.map,
                      .belief = *inputs.belief,
                      .guidance = std::nullopt,
                      .neighbours = board_.NeighboursOf(options_.robot)};
  newest_revision_ = inputs.guidance ? inputs.guidance->revision : 0;
  if (inputs.guidance && !inputs.guidance->path.empty()) {
    guided_before_ = true;
    if (inputs.guidance->valid_until >= situation.state.stamp) situation.guidance = inputs.guidance;
  }
  situation.guided_before = guided_before_;
  return situation;
}

void RobotWorker::Publish(Decision decision, const Situation& situation, double duration_ms) {
  const RobotState& state = situation.state;
  if (decision.action) {
    SearchReport& report = decision.report;
    report.stamp = state.stamp;
    report.world = state.world;
    report.robot = state.robot;
    report.method = options_.method_name;
    report.decision = ++decisions_;
    report.cell = state.cell;
    report.belief_revision = situation.belief.revision;
    report.guidance_revision = situation.guidance ? situation.guidance->revision : 0;
    report.duration_ms = duration_ms;
    outputs_.report(report);
    outputs_.way(state, situation.map, decision.plan);
    command_sent_at_ = clock_.Now();
    outputs_.command(desk_.Issue(*decision.action, state, board_.NewestStamp(options_.robot)));
  }
  if (decision.attention) Ask(decision, situation);
}

void RobotWorker::Ask(const Decision& decision, const Situation& situation) {
  AttentionRequest request;
  request.stamp = situation.state.stamp;
  request.world = situation.state.world;
  request.robot = situation.state.robot;
  request.sequence_number = ++attentions_;
  request.reason = *decision.attention;
  request.cell = decision.attention_cell;
  request.newest_snapshot = situation.state.snapshots;
  request.expected_information = decision.expected_information;
  outputs_.attention(request);
  if (decision.action) return;
  waiting_for_guidance_ = true;
  waiting_beyond_revision_ = newest_revision_;
}

}  // namespace conav::planner
