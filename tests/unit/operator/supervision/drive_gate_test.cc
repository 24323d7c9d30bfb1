#include <catch2/catch.hpp>

#include "operator/supervision/control.h"

using namespace conav;
using namespace conav::operators;
using namespace std::chrono_literals;

namespace {

struct DriveBench {
  DriveBench() { gate.Receive(State(0)); }

  static RobotState State(std::uint64_t drive_order) {
    return {.world = "w1", .robot = "r1", .drive_order = drive_order};
  }
  static OperatorRequest Request(std::uint64_t id, DriveAction drive = DriveAction::kForward,
                                 const std::string& client = "ann",
                                 SimTime expires = SimTime{} + 2s,
                                 const std::string& robot = "r1") {
    return {{}, client, id, "w1", DriveRequest{robot, drive, expires}};
  }
  DriveGate::Answer Handle(const OperatorRequest& request) {
    return gate.Handle(request, now, wall);
  }

  DriveGate gate{{{"r1", "w1"}, {"r2", "w1"}, {"r3", "w2"}}};
  SimTime now = SimTime{} + 1s;
  Clock::TimePoint wall{};
};

}  // namespace

TEST_CASE("an order is passed on once, with the next number of its robot", "[operator][driving]") {
  DriveBench gate;
  const DriveGate::Answer first = gate.Handle(DriveBench::Request(1, DriveAction::kTurnLeft));
  CHECK(first.reply.accepted);
  REQUIRE(first.order);
  CHECK(*first.order ==
        DriveOrder{gate.now, "w1", "r1", 1, DriveAction::kTurnLeft, "ann", SimTime{} + 2s});
  CHECK(gate.Handle(DriveBench::Request(2)).reply.revision == 2);
  const DriveGate::Answer sent = gate.Handle(DriveBench::Request(5));
  gate.now = SimTime{} + 100s;  // even when it has expired meanwhile
  const DriveGate::Answer repeat = gate.Handle(DriveBench::Request(5));
  CHECK(repeat.reply == sent.reply);
  CHECK_FALSE(repeat.order);
}

TEST_CASE("an order that must not be carried out is refused with its reason",
          "[operator][driving]") {
  DriveBench gate;
  gate.Handle(DriveBench::Request(10));
  struct Row {
    std::uint64_t id;
    SimTime expires;
    std::string robot;
    std::string named;
  };
  for (const Row& row : std::vector<Row>{{11, SimTime{} + 1s, "r1", "1.000 s"},
                                         {12, SimTime{} + 6500ms, "r1", "limit is 5 s"},
                                         {13, SimTime{} + 2s, "r9", "r9"},
                                         {14, SimTime{} + 2s, "r3", "world w1"},
                                         {15, SimTime{} + 2s, "r2", "r2"},
                                         {9, SimTime{} + 2s, "r1", "request 15"}}) {
    CAPTURE(row.id);
    const DriveGate::Answer answer = gate.Handle(
        DriveBench::Request(row.id, DriveAction::kForward, "ann", row.expires, row.robot));
    CHECK_FALSE(answer.reply.accepted);
    CHECK_FALSE(answer.order);
    CHECK_THAT(answer.reply.reason, Catch::Contains(row.named));
  }
}

TEST_CASE("a request is late beyond what the two clocks differ by", "[operator]") {
  const double offset_s = GENERATE(0.0, -1000.0, 1000.0);  // of the client's clock
  RequestDelays delays;
  const auto late = [&](const std::string& client, double sent_s, double arrived_s) {
    return delays.IsLate(client, sent_s + offset_s, arrived_s);
  };
  CHECK_FALSE(late("ann", 0.0, 0.2));
  CHECK_FALSE(late("ann", 1.0, 4.2));
  CHECK(late("ann", 1.0, 4.3));
  CHECK_FALSE(late("bob", 1.0, 4.3));  // its first: nothing is known of its clock
  CHECK_FALSE(late("ann", 4.0, 4.1));  // the quickest now
  CHECK(late("ann", 5.0, 8.2));
  // After a minute the clocks are compared again: they may have been set.
  CHECK_FALSE(late("ann", 60.0, 70.0));
}

TEST_CASE("one client steers a robot, anybody may stop it", "[operator][driving]") {
  DriveBench gate;
  gate.Handle(DriveBench::Request(1));
  const DriveGate::Answer other = gate.Handle(DriveBench::Request(1, DriveAction::kForward, "bob"));
  CHECK_THAT(other.reply.reason, Catch::Contains("ann"));
  CHECK(gate.Handle(DriveBench::Request(2, DriveAction::kStop, "bob")).order);
  CHECK(gate.gate.DriverOf("r1", gate.wall) == "ann");
  gate.wall += 5s;
  CHECK(gate.gate.DriverOf("r1", gate.wall).empty());
  CHECK(gate.Handle(DriveBench::Request(3, DriveAction::kForward, "bob")).order);
  CHECK_THAT(gate.Handle(DriveBench::Request(2)).reply.reason, Catch::Contains("bob"));
}

TEST_CASE("of a burst only the newest order counts, a restarted service continues the numbers",
          "[operator][driving]") {
  std::vector<OperatorRequest> burst{
      DriveBench::Request(1), DriveBench::Request(2), DriveBench::Request(2),
      DriveBench::Request(1, DriveAction::kForward, "bob"),
      DriveBench::Request(3, DriveAction::kForward, "ann", {}, "r2")};
  burst.push_back({{}, "ann", 4, "w1", EditRequest{}});
  REQUIRE(ReplacedBy(burst, 0) != nullptr);
  CHECK(ReplacedBy(burst, 0)->request_id == 2);
  for (std::size_t i = 1; i < burst.size(); ++i) CHECK(ReplacedBy(burst, i) == nullptr);
  DriveBench gate;
  gate.gate.Receive(DriveBench::State(41));
  CHECK(gate.Handle(DriveBench::Request(1)).reply.revision == 42);
}
