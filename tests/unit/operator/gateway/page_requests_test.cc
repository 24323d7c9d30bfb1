// What pages ask: as the domain has it, and whether it is allowed now.
#include <catch2/catch.hpp>
#include <limits>

#include "operator/console/console_messages.h"
#include "operator/gateway/page_feed.h"

namespace conav::operators {
namespace {

constexpr SimTime kNow{5'000'000'000};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

console::Request Base() {
  console::Request request;
  request.set_id(7);
  request.set_world("w1");
  request.set_valid_until(100.0);
  return request;
}

console::Request EditOf(int row, int column) {
  console::Request request = Base();
  request.mutable_edit()->set_base_revision(3);
  console::CellEdit* edit = request.mutable_edit()->add_cells();
  edit->mutable_cell()->set_row(row);
  edit->mutable_cell()->set_column(column);
  edit->set_wall(true);
  return request;
}

console::Request GuideOf(double valid_for) {
  console::Request request = Base();
  request.mutable_guide()->set_robot("r1");
  for (const int column : {4, 5}) {
    console::Cell* cell = request.mutable_guide()->add_path();
    cell->set_row(2);
    cell->set_column(column);
  }
  request.mutable_guide()->set_answers_snapshot(9);
  request.mutable_guide()->set_valid_for(valid_for);
  return request;
}

console::Request DriveOf(console::DriveAction action, double expires_at = 6.5) {
  console::Request request = Base();
  request.mutable_drive()->set_robot("r1");
  request.mutable_drive()->set_action(action);
  request.mutable_drive()->set_expires_at(expires_at);
  return request;
}

console::Request SelectOf(console::AttentionReason reason) {
  console::Request request = Base();
  request.mutable_select()->set_robot("r1");
  request.mutable_select()->set_reason(reason);
  return request;
}

Result<OperatorRequest> Convert(const console::Request& request) {
  return ToOperatorRequest(request, "anna/0123456789abcdef", kNow);
}

OperatorRequest Expected(decltype(OperatorRequest::body) body) {
  return {kNow, "anna/0123456789abcdef", 7, "w1", std::move(body)};
}

std::string WhyNotNow(const console::Request& request, console::Role role = console::ROLE_OPERATOR,
                      double round_trip_s = 0.0, double wall_s = 99.0) {
  return CheckNow({"anna/1", "anna", role}, {request, round_trip_s}, wall_s, 1.0);
}

}  // namespace

TEST_CASE("each kind of request becomes what the bus asks", "[operator][gateway]") {
  CHECK(Convert(EditOf(1, 2)).value() == Expected(EditRequest{3, {{{1, 2}, true}}}));
  CHECK(Convert(GuideOf(30.0)).value() == Expected(GuideRequest{"r1", {{2, 4}, {2, 5}}, 9, 30.0}));
  CHECK(Convert(DriveOf(console::DRIVE_TURN_LEFT)).value() ==
        Expected(DriveRequest{"r1", DriveAction::kTurnLeft, SimTime{6'500'000'000}}));
  CHECK(Convert(SelectOf(console::REASON_BLOCKED)).value() ==
        Expected(SelectRequest{"r1", AttentionReason::kBlocked}));
  console::Request finish = Base();
  finish.mutable_finish();
  CHECK(std::holds_alternative<FinishRequest>(Convert(finish).value().body));
  console::Request withdrawn = GuideOf(30.0);
  withdrawn.mutable_guide()->clear_path();
  CHECK(std::get<GuideRequest>(Convert(withdrawn).value().body).path.empty());
}

TEST_CASE("a request that means nothing is refused by the field", "[operator][gateway]") {
  std::vector<std::pair<console::Request, const char*>> rows{
      {EditOf(-1, 2), "cell"},
      {EditOf(1, std::numeric_limits<int>::max()), "cell"},
      {EditOf(1, 2), "edits"},
      {SelectOf(console::REASON_NONE), ""}};
  console::Request& large = rows[2].first;
  for (int i = 0; i < 65536; ++i) *large.mutable_edit()->add_cells() = large.edit().cells(0);
  for (const double time : {-1.0, kInfinity, -kInfinity, kNan, 1e300}) {
    rows.emplace_back(GuideOf(time), "valid_for");
    rows.emplace_back(DriveOf(console::DRIVE_FORWARD, time), "expires_at");
  }
  rows.emplace_back(GuideOf(0.0), "valid_for");
  for (const int number : {-1, 99, 256, 257}) {
    rows.emplace_back(DriveOf(static_cast<console::DriveAction>(number)), "action");
    rows.emplace_back(SelectOf(static_cast<console::AttentionReason>(number)), "reason");
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto& [request, field] = rows[row];
    CAPTURE(row, field);
    const auto converted = Convert(request);
    REQUIRE_FALSE(converted);
    CHECK_THAT(converted.error().text, Catch::Contains(field));
  }
  CHECK(Convert(Base()).error().code == ErrorCode::kMalformed);
}

TEST_CASE("a wrong name is refused", "[operator][gateway]") {
  console::Request request = GuideOf(30.0);
  SECTION("no id") { request.set_id(0); }
  SECTION("no world") { request.clear_world(); }
  SECTION("a world that is no name") { request.set_world("w/1"); }
  SECTION("a robot that is no name") { request.mutable_guide()->set_robot("r 1"); }
  SECTION("a long name") { request.mutable_guide()->set_robot(std::string(65, 'r')); }
  CHECK_FALSE(Convert(request));
}

TEST_CASE("operators and admins may ask in time, an observer may stop robots and nothing else",
          "[operator][gateway]") {
  CHECK(WhyNotNow(EditOf(1, 2)).empty());
  CHECK(WhyNotNow(EditOf(1, 2), console::ROLE_ADMIN).empty());
  CHECK(WhyNotNow(EditOf(1, 2), console::ROLE_OPERATOR, 0.0, 100.0).empty());
  for (const auto& request : {EditOf(1, 2), GuideOf(30.0), DriveOf(console::DRIVE_STOP),
                              SelectOf(console::REASON_BLOCKED)}) {
    CHECK_THAT(WhyNotNow(request, console::ROLE_OBSERVER), Catch::Contains("observer"));
  }
  console::Request stop = Base();
  stop.mutable_stop();
  CHECK(WhyNotNow(stop, console::ROLE_OBSERVER).empty());
}

TEST_CASE("a request that comes late is refused", "[operator][gateway]") {
  CHECK_THAT(WhyNotNow(EditOf(1, 2), console::ROLE_OPERATOR, 0.0, 102.5), Catch::Contains("2.5"));
  console::Request request = EditOf(1, 2);
  request.set_valid_until(GENERATE(0.0, kNan, -kInfinity));
  CHECK_FALSE(WhyNotNow(request).empty());
}

TEST_CASE("nobody drives over a slow connection, and everybody may stop", "[operator][gateway]") {
  CHECK(WhyNotNow(DriveOf(console::DRIVE_FORWARD), console::ROLE_OPERATOR, 1.0).empty());
  CHECK_FALSE(WhyNotNow(DriveOf(console::DRIVE_FORWARD), console::ROLE_OPERATOR, 1.1).empty());
  CHECK(WhyNotNow(DriveOf(console::DRIVE_STOP), console::ROLE_OPERATOR, 1.1).empty());
  CHECK(WhyNotNow(EditOf(1, 2), console::ROLE_OPERATOR, 1.1).empty());
}

}  // namespace conav::operators
