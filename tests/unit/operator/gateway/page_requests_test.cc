// What pages ask: as the domain has it, and whether it is allowed now.
#include <fmt/core.h>
#include <google/protobuf/text_format.h>

#include <catch2/catch.hpp>
#include <limits>

#include "operator/console/console_messages.h"
#include "operator/gateway/page_feed.h"

namespace conav::operators {
namespace {

constexpr SimTime kNow{5'000'000'000};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Request 7 about world w1, with a body in protobuf's text.
console::Request RequestOf(const std::string& body) {
  console::Request request;
  REQUIRE(google::protobuf::TextFormat::ParseFromString(
      fmt::format("id: 7 world: 'w1' valid_until: 100 {}", body), &request));
  return request;
}

console::Request EditOf(int row, int column) {
  return RequestOf(fmt::format(
      "edit {{ base_revision: 3 cells {{ cell {{ row: {} column: {} }} wall: true }} }}", row,
      column));
}

console::Request GuideOf(double valid_for) {
  return RequestOf(
      fmt::format("guide {{ robot: 'r1' path {{ row: 2 column: 4 }} answers_snapshot: 9"
                  " path {{ row: 2 column: 5 }} valid_for: {} }}",
                  valid_for));
}

console::Request DriveOf(int action, double expires_at = 6.5) {
  return RequestOf(
      fmt::format("drive {{ robot: 'r1' action: {} expires_at: {} }}", action, expires_at));
}

console::Request SelectOf(int reason) {
  return RequestOf(fmt::format("select {{ robot: 'r1' reason: {} }}", reason));
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
  CHECK(std::holds_alternative<FinishRequest>(Convert(RequestOf("finish {}")).value().body));
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
    rows.emplace_back(DriveOf(number), "action");
    rows.emplace_back(SelectOf(number), "reason");
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto& [request, field] = rows[row];
    CAPTURE(row, field);
    const auto converted = Convert(request);
    REQUIRE_FALSE(converted);
    CHECK_THAT(converted.error().text, Catch::Contains(field));
  }
  CHECK(Convert(RequestOf("")).error().code == ErrorCode::kMalformed);
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
  CHECK(WhyNotNow(RequestOf("stop {}"), console::ROLE_OBSERVER).empty());
}

TEST_CASE("an experimenter pauses, aborts and writes notes, and commands nothing",
          "[operator][gateway]") {
  for (const char* body : {"pause { on: true }", "abort { reason: 'unwell' }"}) {
    CAPTURE(body);
    CHECK(WhyNotNow(RequestOf(body), console::ROLE_EXPERIMENTER).empty());
    for (const auto role : {console::ROLE_OBSERVER, console::ROLE_OPERATOR, console::ROLE_ADMIN}) {
      CHECK_THAT(WhyNotNow(RequestOf(body), role), Catch::Contains("experimenter"));
    }
  }
  for (const char* body : {"note { text: 'calm' }", "stop {}"}) {
    CHECK(WhyNotNow(RequestOf(body), console::ROLE_EXPERIMENTER).empty());
  }
  for (const char* body : {"resume {}", "finish {}", "answers { json: '{}' }", "begin {}"}) {
    CAPTURE(body);
    CHECK_FALSE(WhyNotNow(RequestOf(body), console::ROLE_EXPERIMENTER).empty());
    CHECK(WhyNotNow(RequestOf(body)).empty());
  }
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
