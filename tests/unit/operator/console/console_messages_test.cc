#include "operator/console/console_messages.h"

#include <fmt/core.h>
#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <random>
#include <set>

#include "operator/console/participant_task.h"
#include "support/packed_grid.h"
#include "unit/common/msg/samples.h"
#include "unit/operator/support/updates.h"

namespace conav::operators {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

bool IsSet(const Message& message, const FieldDescriptor& field) {
  const auto* reflection = message.GetReflection();
  return field.is_repeated() ? reflection->FieldSize(message, &field) > 0
                             : reflection->HasField(message, &field);
}

/// Names of fields, also of messages within, that are at their default everywhere.
std::set<std::string> Unset(const Message& message) {
  std::set<std::string> unset;
  const auto* reflection = message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *message.GetDescriptor()->field(i);
    if (!IsSet(message, field)) unset.insert(field.name());
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || !IsSet(message, field)) continue;
    const Message& within = field.is_repeated() ? reflection->GetRepeatedMessage(message, &field, 0)
                                                : reflection->GetMessage(message, &field);
    for (const auto& name : Unset(within)) {
      unset.insert(fmt::format("{}.{}", field.name(), name));
    }
  }
  return unset;
}

const std::set<std::string> kNone;

constexpr GridGeometry kGrid{3, 4, 2.0};

TEST_CASE("a robot's state fills every field", "[operator][console]") {
  const RobotState state = samples::SampleState();
  const console::Robot robot = ToConsole(state, 12.5);
  CHECK(Unset(robot) == kNone);
  CHECK(robot.stamp() == Approx(state.stamp.ToSeconds()));
  CHECK(robot.received_at() == 12.5);
  CHECK(robot.cell().row() == 3);
  CHECK(robot.x() == 1.25);
  CHECK(robot.y() == -3.5);
  CHECK(robot.goals_left_size() == 2);
  CHECK(robot.outcome() == console::OUTCOME_BLOCKED);
  CHECK(robot.cell_moves() == 20);
  CHECK(robot.low_level_steps() == 300);
  CHECK(robot.images() == 5);
}

TEST_CASE("outcomes have the same numbers here and there", "[operator][console]") {
  for (int i = 0; i <= static_cast<int>(CommandOutcome::kExpired); ++i) {
    CHECK(console::CommandOutcome_IsValid(i));
  }
  CHECK(static_cast<int>(CommandOutcome::kExpired) == console::OUTCOME_EXPIRED);
  CHECK(static_cast<int>(AttentionReason::kGoalsReached) == console::REASON_GOALS_REACHED);
  CHECK(static_cast<int>(DriveAction::kTurnRight) == console::DRIVE_TURN_RIGHT);
}

TEST_CASE("guidance, pictures, searches, the queue and tasks fill every field",
          "[operator][console]") {
  const console::Guidance guidance = ToConsole(samples::SampleGuidance());
  CHECK(Unset(guidance) == kNone);
  CHECK(guidance.path_size() == 3);
  CHECK(guidance.revision() == 2);
  CHECK(guidance.answers_snapshot() == 3);
  const console::Snapshot snapshot = ToConsole(samples::SampleSnapshot(), 12.5);
  CHECK(Unset(snapshot) == std::set<std::string>{"answer", "answered_by"});
  CHECK(snapshot.bytes() == 3);
  CHECK(snapshot.width() == 320);
  CHECK(snapshot.height() == 192);
  CHECK(snapshot.free_cells().row_size() == 2);
  CHECK(snapshot.wall_cells().column(0) == 3);
  const console::Search search = ToConsole(samples::SampleReport());
  CHECK(Unset(search) == std::set<std::string>{"actions.snapshot"});  // the first is a move
  const console::SearchAction& action = search.actions(1);
  CHECK(action.snapshot());
  CHECK(action.heading() == 1.5);
  CHECK(action.visits() == 10);
  const console::Attention attention = ToConsole(samples::SampleQueue());
  CHECK(Unset(attention) == kNone);
  CHECK(attention.items(0).reason() == console::REASON_BLOCKED);
  CHECK(attention.items(0).expected_interaction() == 6.0);
  CHECK(attention.items(0).gives_up_after() == 12.5);
  CHECK(attention.fan_out() == 2.6);
  CHECK(attention.predicted_waiting_time() == 4.0);
  TaskOptions options{.kind = "rest",
                      .step = "rest-1",
                      .participant = "P07",
                      .number = 2,
                      .count = 3,
                      .title = "Rest",
                      .earlier = {0.5},
                      .rest_s = 60.0,
                      .introduction = "Look at the cross.",
                      .completion_code = "C-1"};
  const console::Task task =
      ToConsole(options, {TaskPhase::kFinished, 1, true, 0.75, 7.5, 1e9, true, true});
  CHECK(Unset(task) == std::set<std::string>{"tags", "words"});  // added later
  CHECK(task.kind() == console::TASK_REST);
  CHECK(task.time_limit() == 60.0);
  CHECK(task.used() == 7.5);
  CHECK(task.phase() == console::PHASE_FINISHED);
  CHECK(task.number() == 2);
  CHECK(task.count() == 3);
  CHECK(task.earlier(0) == 0.5);
  CHECK(task.mapping_accuracy() == 0.75);
  CHECK(task.completion_code() == "C-1");
  options.show_scores = false;
  const console::Task early = ToConsole(options, {.mapping_accuracy = 0.75});
  CHECK(early.completion_code().empty());  // who has not finished does not get it
  CHECK(early.mapping_accuracy() == 0.0);
  CHECK(early.earlier().empty());
}

TEST_CASE("what a page asks about a step is no request of the operator's", "[operator][console]") {
  using Kind = StudyRequest::Kind;
  console::Request request;
  request.set_id(7);
  request.mutable_draft()->set_json("{}");
  const auto draft = ToStudyRequest(request, "page");
  REQUIRE(draft);
  CHECK(draft->kind == Kind::kDraft);
  CHECK(draft->text == "{}");
  CHECK(draft->client == "page");
  CHECK(draft->id == 7);
  CHECK_FALSE(ToOperatorRequest(request, "page", {}));
  request.mutable_answers()->set_json("{}");
  CHECK(ToStudyRequest(request, "page")->kind == Kind::kAnswers);
  request.mutable_begin();
  CHECK(ToStudyRequest(request, "page")->kind == Kind::kBegin);
  request.mutable_pause()->set_on(true);
  CHECK(ToStudyRequest(request, "page")->kind == Kind::kPause);
  request.mutable_pause()->set_on(false);
  CHECK(ToStudyRequest(request, "page")->kind == Kind::kContinue);
  request.mutable_abort()->set_reason("unwell");
  CHECK(ToStudyRequest(request, "page")->text == "unwell");
  request.mutable_finish();
  CHECK_FALSE(ToStudyRequest(request, "page"));
}

TEST_CASE("a session shows robots in their order, and each world once", "[operator][console]") {
  const console::Session session = SessionOf({"w2/r3", "w1/r1", "w2/r2"}, "teleop");
  CHECK(std::vector<std::string>(session.robots().begin(), session.robots().end()) ==
        std::vector<std::string>{"r3", "r1", "r2"});
  CHECK(std::vector<std::string>(session.worlds().begin(), session.worlds().end()) ==
        std::vector<std::string>{"w1", "w2"});
  CHECK(session.drives());
  CHECK_FALSE(SessionOf({"w1/r1"}, "ig-mcts").drives());
}

TEST_CASE("a page gets probabilities and a robot's map as bytes", "[operator][console]") {
  Grid<float> grid(1, 6);
  const std::vector<float> values{0.0F, 0.5F, 1.0F, 0.25F, -3.0F, 7.0F};
  std::copy(values.begin(), values.end(), grid.values().begin());
  CHECK(test::UnpackedCells(Packed(grid)) == std::string("\x00\x80\xFF\x40\x00\xFF", 6));
  OccupancyGrid seen(1, 3, Occupancy::kUnknown);
  seen[{0, 1}] = Occupancy::kFree;
  seen[{0, 2}] = Occupancy::kOccupied;
  CHECK(test::UnpackedCells(Packed(seen)) == std::string("\x00\x01\x02", 3));
}

TEST_CASE("packed grids hold every cell, and are small where rows are alike",
          "[operator][console]") {
  // Three columns; a row of 1, 2, 2 twice, then one of 2, 2, 2: runs of XORs.
  OccupancyGrid rows(3, 3, Occupancy::kOccupied);
  rows[{0, 0}] = rows[{1, 0}] = Occupancy::kFree;
  CHECK(Packed(rows) == std::string("\x03\x01\x01\x02\x02\x03\x00\x01\x03\x02\x00", 11));
  std::mt19937 random(5);
  for (int i = 0; i < 100; ++i) {
    const auto draw = [&](int count) { return static_cast<int>(random() % count); };
    OccupancyGrid cells(1 + draw(9), 1 + draw(400), Occupancy::kUnknown);
    for (int change = draw(20); change > 0; --change) {
      cells[{draw(cells.rows()), draw(cells.columns())}] = Occupancy::kOccupied;
    }
    std::string bytes;
    for (const Occupancy cell : cells.values()) bytes.push_back(static_cast<char>(cell));
    CHECK(test::UnpackedCells(Packed(cells)) == bytes);
  }
  OccupancyGrid corridor(1000, 1000, Occupancy::kOccupied);
  for (int row = 1; row < 999; ++row) corridor[{row, 500}] = Occupancy::kFree;
  CHECK(Packed(corridor).size() < 30);
}

TEST_CASE("positions on the map have a cell, others none", "[operator][console]") {
  CHECK(CellAt({0.5, 0.5}, kGrid) == Cell{1, 2});
  CHECK(CellAt({-3.9, 2.9}, kGrid) == Cell{0, 0});
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const Position position : {Position{4.1, 0.0}, Position{0.0, -3.1}, Position{1e300, 0.0},
                                  Position{none, 0.0}, Position{0.0, none}}) {
    CHECK_FALSE(CellAt(position, kGrid));
  }
}

TEST_CASE("cells of a path end with the map", "[operator][console]") {
  const std::vector<Position> path{{0.5, 0.5}, {0.5, 2.5}, {0.5, 9.0}, {0.5, 0.5}};
  CHECK(CellsAt(path, kGrid) == std::vector<Cell>{{1, 2}, {0, 2}});
  CHECK(CellsAt({}, kGrid).empty());
}

TEST_CASE("encoded updates one behind the other are one message", "[operator][console]") {
  const bool everything = GENERATE(false, true);
  const auto sent = GENERATE_COPY(
      std::vector<console::Update>{},
      std::vector{Said("a", "first"), Said("b", std::string(300, 'x')), console::Update()});
  std::string body;
  for (const console::Update& update : sent) body += EncodeUpdate(update);
  console::ServerMessage message;
  REQUIRE(message.ParseFromString(EncodeUpdates(body, everything)));
  REQUIRE(message.has_updates());
  CHECK(message.updates().everything() == everything);
  REQUIRE(message.updates().update_size() == static_cast<int>(sent.size()));
  for (std::size_t i = 0; i < sent.size(); ++i) {
    CHECK(message.updates().update(static_cast<int>(i)).SerializeAsString() ==
          sent[i].SerializeAsString());
  }
}

TEST_CASE("An edit and a path of as many cells as allowed fit into a message", "[operator]") {
  constexpr std::size_t kMessage = 512 * 1024;
  const RequestLimits limits = LimitsOf(kMessage, {65536, 65536});
  const auto size_of = [](console::Request request) {
    request.set_id(~std::uint64_t{0});
    request.set_valid_until(1e9);
    request.set_world(std::string(64, 'w'));
    return request.ByteSizeLong() + 16;  // and the message around it
  };
  const console::Cell cell = ToConsole(Cell{1023, 1023});
  console::Request edit;
  console::Request guide;
  guide.mutable_guide()->set_robot(std::string(64, 'r'));
  edit.mutable_edit()->set_base_revision(~std::uint64_t{0});
  for (std::uint32_t i = 0; i < limits.edit_cells; ++i) {
    *edit.mutable_edit()->add_cells()->mutable_cell() = cell;
    edit.mutable_edit()->mutable_cells(static_cast<int>(i))->set_wall(true);
  }
  for (std::uint32_t i = 0; i < limits.path_cells; ++i) *guide.mutable_guide()->add_path() = cell;
  CHECK(std::max(size_of(edit), size_of(guide)) <= kMessage);
  CHECK(limits.edit_cells > 40'000);  // all of a map of 150 x 150 twice over
  CHECK(LimitsOf(kMessage, {100, 200}) == RequestLimits{100, 200});
}

}  // namespace
}  // namespace conav::operators
