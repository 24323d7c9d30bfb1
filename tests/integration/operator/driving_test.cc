#include "integration/operator/operator_bench.h"

namespace conav::operators {
namespace {

/// The simulator's time is 1 s.
struct DrivingBench : OperatorBench {
  DrivingBench() {
    sim.PublishInitialMap(kMap);
    sim.PublishState({1, 1}, 1'000'000'000);
    service.Step();
  }

  static DriveRequest Key(DriveAction drive) { return {"r1", drive, SimTime::FromSeconds(2.0)}; }
  std::vector<DriveOrder> Orders() {
    return orders.TakeValid([](const auto& message) { return ToDomain(message); });
  }

  bus::Subscriber<conav_msgs::msg::DriveOrder> orders{client_participant, bus::kDriveOrder, "r1"};
};

TEST_CASE("A key is passed on to the planner and acknowledged with its number",
          "[operator][integration]") {
  DrivingBench bench;
  const OperatorReply reply = bench.Ask(DrivingBench::Key(DriveAction::kTurnLeft));
  CHECK(reply.accepted);
  CHECK(reply.revision == 1);
  CHECK(bench.Orders() ==
        std::vector<DriveOrder>{{SimTime::FromSeconds(1.0), "w1", "r1", 1, DriveAction::kTurnLeft,
                                 "anna", SimTime::FromSeconds(2.0)}});
  // Nothing of it is stored: neither belief nor guidance changed.
  CHECK(bench.sim.NewestBelief().revision == 0);
  CHECK(bench.sim.guidance.Take().empty());
}

TEST_CASE("Of keys that piled up while the service was away only the newest is passed on",
          "[operator][integration]") {
  DrivingBench bench;
  std::uint64_t newest = 0;
  for (int i = 0; i < 8; ++i) {
    newest = bench.client.Send("w1", DrivingBench::Key(DriveAction::kForward), {});
  }
  bench.service.Step();
  CHECK(bench.Orders().size() == 1);
  const auto outcomes = bench.client.Poll();
  CHECK(outcomes.size() == 8);
  for (const auto& outcome : outcomes) {
    CHECK(outcome.reply.value().accepted == (outcome.request_id == newest));
  }
}

}  // namespace
}  // namespace conav::operators
