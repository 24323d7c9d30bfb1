#pragma once

#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"

/// One value of each kind with no field at its default.
namespace conav::samples {

inline SimTime Stamp(int n) { return {n * 1'000'000'000LL + 123'456'789}; }

inline MapUpdate SampleMap() {
  MapUpdate map{Stamp(3), 2.5, OccupancyGrid(2, 3, Occupancy::kUnknown)};
  map.cells[{0, 0}] = Occupancy::kOccupied;
  map.cells[{1, 2}] = Occupancy::kFree;
  map.middle = {10.25, -4.5};
  return map;
}

inline RobotCommand SampleCommand() {
  return {.stamp = Stamp(1),
          .robot = "r1",
          .sequence_number = 7,
          .lease_epoch = 3,
          .expires_at = Stamp(5),
          .kind = CommandKind::kTransmitView,
          .path = {{1.5, -2.0}, {3.25, 4.0}},
          .tolerance_m = 0.25,
          .arrival_heading_rad = 1.5,
          .heading_rad = -1.25,
          .drive = DriveAction::kTurnLeft,
          .drive_order = 8};
}

inline RobotState SampleState() {
  return {.stamp = Stamp(2),
          .world = "w1",
          .robot = "r2",
          .grid = {12, 10, 2.0, {0.5, -8.0}},
          .cell = {3, 4},
          .heading_rad = 0.5,
          .position = {1.25, -3.5},
          .speed_mps = 0.75,
          .yaw_rate_rps = -0.125,
          .goals_stamp = Stamp(1),
          .goals_left = {{1, 2}, {3, 4}},
          .goals_reached = {{9, 8}},
          .goals_total = 4,
          .path = {{3, 3}, {3, 4}},
          .command_sequence_number = 11,
          .command_outcome = CommandOutcome::kBlocked,
          .command_detail = "wall ahead",
          .command_cell = {2, 4},
          .drive_order = 13,
          .lease_epoch = 6,
          .cell_moves = 20,
          .distance_m = 41.5,
          .low_level_steps = 300,
          .images = 5,
          .image_bytes = 50000,
          .camera_bytes = 7000,
          .snapshots = 4,
          .map_stamp = Stamp(1),
          .stopped = true,
          .stop_revision = 9};
}

inline RobotGoals SampleGoals() { return GoalsOf(SampleState(), 0.75); }

inline Snapshot SampleSnapshot() {
  return {.stamp = Stamp(4),
          .world = "w1",
          .robot = "r1",
          .sequence_number = 9,
          .streamed = true,
          .grid = {7, 8, 2.0, {-1.0, 3.0}},
          .cell = {2, 2},
          .position = {0.5, 1.25},
          .heading_rad = 1.5,
          .horizontal_fov_rad = 1.4,
          .width = 320,
          .height = 192,
          .jpeg = {0xFF, 0xD8, 0xFF},
          .visible = {{{2, 2}, {2, 3}}, {{1, 3}, {2, 4}}},
          .path = {{2, 1}, {2, 2}},
          .goals_left = {{5, 5}}};
}

inline BeliefGrid SampleBeliefGrid() {
  BeliefGrid grid(2, 3, 0.25F);
  grid[{0, 2}] = 1.0F;
  grid[{1, 0}] = 0.1F;
  return grid;
}

inline Belief SampleBelief() {
  return {Stamp(6), "w2", 12, SampleBeliefGrid(), "browser-1", 0.5, {3.0, 4.0}};
}

inline Guidance SampleGuidance() {
  return {.stamp = Stamp(7),
          .world = "w1",
          .robot = "r1",
          .revision = 2,
          .path = {{1, 1}, {1, 2}, {2, 2}},
          .given_by = "simulated_operator",
          .belief_revision = 5,
          .answers_snapshot = 3,
          .valid_until = Stamp(99)};
}

inline OperatorRequest SampleEdit() {
  return {Stamp(8), "browser-1", 4, "w1", EditRequest{6, {{{1, 2}, true}, {{3, 4}, false}}}};
}

inline OperatorRequest SampleGuide() {
  return {Stamp(8), "browser-1", 5, "w1", GuideRequest{"r3", {{1, 2}, {1, 3}}, 8, 120.5}};
}

inline OperatorRequest SampleDrive() {
  return {Stamp(9), "browser-1", 6, "w1", DriveRequest{"r1", DriveAction::kTurnRight, Stamp(10)}};
}

inline DriveOrder SampleDriveOrder() {
  return {Stamp(9), "w1", "r1", 17, DriveAction::kBackward, "browser-1", Stamp(10)};
}

inline OperatorReply SampleReply() { return {"browser-1", 4, true, "because", 13}; }

inline AttentionRequest SampleAttention() {
  return {Stamp(9), "w1", "r1", 3, AttentionReason::kBlocked, {7, 8}, 2, 0.5, 1.75, Stamp(12), 2.5};
}

inline OperatorRequest SampleSelect() {
  return {Stamp(8), "browser-1", 6, "w1", SelectRequest{"r3", AttentionReason::kNoGuidance}};
}

inline StopOrder SampleStop() {
  return {Stamp(7), "w1", "r1", 3, true, "browser-1", "a person walks there"};
}

/// A request of each kind that names robots or an alert.
inline std::vector<OperatorRequest> SampleControlRequests() {
  const auto request = [](auto body) {
    return OperatorRequest{Stamp(8), "browser-1", 7, "w1", std::move(body)};
  };
  return {request(AnswerRequest{"r2", 5}),
          request(StopRequest{{"r1", "r2"}, "a person walks there"}),
          request(ResumeRequest{{"r2"}}),
          request(TakeControlRequest{{"r1"}, "shift change", true}),
          request(ReleaseControlRequest{{"r1", "r2"}, "ben/3f"}),
          request(AcknowledgeRequest{9}),
          request(ShelveRequest{9, 60.0}),
          request(FinishRequest{}),
          request(GoalsRequest{"r2", {{1.5, -2.5}, {0.25, 3.0}}, {{-4.0, 5.5}}}),
          request(NoteRequest{"the door was open"})};
}

inline OperatorEvent SampleEvent() {
  return {Stamp(8), RequestKind::kGuide, false, "Ann/2a", "w1", "r1", "drew a path", 7, 3};
}

inline AttentionQueueState SampleQueue() {
  const AttentionItem item{.world = "w1",
                           .robot = "r2",
                           .reason = AttentionReason::kBlocked,
                           .tier = 3,
                           .since = Stamp(3),
                           .deadline = Stamp(20),
                           .gives_up_after_s = 12.5,
                           .cell = {4, 5},
                           .newest_snapshot = 6,
                           .source_sequence = 7,
                           .value_lost_per_s = 1.5,
                           .expected_information = 0.25,
                           .expected_interaction_s = 6.0,
                           .score = 0.25,
                           .selected_by = "browser-1"};
  AttentionItem notice = item;
  notice.reason = AttentionReason::kGoalsReached;
  notice.tier = 5;
  notice.selected_by = std::string();
  const OperatorWorkload workload{
      .robots = 3,
      .interactions = 4,
      .abandoned = 1,
      .observed_s = 90.0,
      .busy_s = 30.0,
      .interaction_time_s = 7.5,
      .neglect_time_s = 12.0,
      .waiting_time_s = 3.0,
      .waiting_time_p95_s = 5.0,
      .value_lost = 21.0,
      .utilisation = 0.5,
      .attended_robots = 2.25,
      .fan_out = 2.6,
      .fan_out_with_waits = 2.1,
      .predicted_utilisation = 0.75,
      .predicted_waiting_time_s = 4.0,
  };
  return {Stamp(10), 8, "priority", {item, notice}, workload};
}

inline SearchReport SampleReport() {
  return {.stamp = Stamp(10),
          .world = "w1",
          .robot = "r1",
          .method = "ig-mcts",
          .decision = 14,
          .cell = {1, 1},
          .belief_revision = 3,
          .guidance_revision = 2,
          .actions = {{CommandKind::kMove,
                       {1, 2},
                       0.25,
                       90,
                       -3.5,
                       0.125,
                       0.5,
                       {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}},
                      {CommandKind::kTransmitView,
                       {2, 1},
                       1.5,
                       10,
                       -12.0,
                       2.25,
                       0.75,
                       {-1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -7.0}}},
          .chosen = 1,
          .has_terms = true,
          .tree = {{-1, CommandKind::kMove, {1, 1}, 0.5, 100, -4.0, 0.25},
                   {0, CommandKind::kTransmitView, {1, 2}, 0.75, 10, -12.5, 0.5}},
          .views = {{{1, 1}, 0.5, 2.25}, {{1, 2}, 1.5, 0.5}},
          .iterations = 1000,
          .nodes = 900,
          .perception_queries = 30,
          .perception_cached = 20,
          .perception_model = "fallback: glpf",
          .duration_ms = 4.5};
}

inline PerceptionQuery SampleQuery() {
  return {SampleBeliefGrid(), {{1, 1}, {1, 2}}, {1, 2}, 0.75, {{{0, 0}, {1, 1}}, {{0, 1}}}};
}

inline PerceptionRequest SampleRequest() {
  return {.client = "planner-77",
          .request_id = 21,
          .replica = "nhpm-2",
          .model = "glpf",
          .model_checksum = std::string(64, 'a'),
          .person = "anna",
          .timeout_ms = 250,
          .queries = {SampleQuery(), SampleQuery()}};
}

inline PerceptionReply SamplePerceptionReply() {
  PerceptionAnswer answer{Grid<float>(2, 3, 0.25F), Grid<float>(2, 3, 0.5F)};
  return {.client = "planner-77",
          .request_id = 21,
          .replica = "nhpm-2",
          .status = PerceptionStatus::kBusy,
          .reason = "why",
          .model = "glpf",
          .model_version = "1",
          .model_checksum = std::string(64, '7'),
          .answers = {answer, answer}};
}

}  // namespace conav::samples
