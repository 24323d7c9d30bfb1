#include <catch2/catch.hpp>

#include "integration/operator/hand_made_sim.h"
#include "operator/simulated/operator_client.h"

namespace conav::operators {
namespace {

/// The service on an in-memory bus, a hand-made simulator whose time is 1 s, and two clients.
struct DrivingBench {
  DrivingBench() {
    sim.PublishInitialMap({"######", "#    #", "######"});
    sim.PublishState({1, 1}, 1'000'000'000);
    service.Step();
  }

  static DriveRequest Key(DriveAction drive, double expires_s = 2.0,
                          const std::string& robot = "r1") {
    return {robot, drive, SimTime::FromSeconds(expires_s)};
  }
  OperatorReply Ask(OperatorClient& client, const DriveRequest& key) {
    const std::uint64_t id = client.Send("w1", key, {});
    service.Step();
    return Reply(client, id);
  }
  static OperatorReply Reply(OperatorClient& client, std::uint64_t id) {
    for (const auto& outcome : client.Poll()) {
      if (outcome.request_id == id && outcome.reply) return *outcome.reply;
    }
    FAIL("no reply to request " << id);
    return {};
  }
  std::vector<DriveOrder> Orders() {
    return orders.TakeValid([](const auto& message) { return ToDomain(message); });
  }

  const TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  HandMadeSim sim{bus};
  bus::Participant operator_participant{"operator", bus};
  bus::Participant client_participant{"client", bus};
  bus::Participant planner_participant{"planner", bus};
  OperatorService service{operator_participant, ConfigFor(folder / "operator.db"), clock};
  OperatorClient anna{client_participant, clock, {"anna", 0.25, 10.0}};
  OperatorClient bert{client_participant, clock, {"bert", 0.25, 10.0}};
  bus::Subscriber<conav_msgs::msg::DriveOrder> orders{planner_participant, bus::kDriveOrder, "r1"};
};

TEST_CASE("A key is passed on to the planner and acknowledged with its number",
          "[operator][integration]") {
  DrivingBench bench;
  const OperatorReply reply = bench.Ask(bench.anna, DrivingBench::Key(DriveAction::kTurnLeft));
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
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 8; ++i) {
    ids.push_back(bench.anna.Send("w1", DrivingBench::Key(DriveAction::kForward), {}));
  }
  bench.service.Step();
  const std::vector<DriveOrder> orders = bench.Orders();
  REQUIRE(orders.size() == 1);
  int refused = 0;
  for (const auto& outcome : bench.anna.Poll()) {
    REQUIRE(outcome.reply);
    CHECK(outcome.reply->accepted == (outcome.request_id == ids.back()));
    refused += outcome.reply->accepted ? 0 : 1;
  }
  CHECK(refused == 7);
}

TEST_CASE("A malformed key reaches nobody, and the next one does", "[operator][integration]") {
  DrivingBench bench;
  bus::Publisher<conav_msgs::msg::OperatorRequest> raw(bench.client_participant,
                                                       bus::kOperatorRequest);
  conav_msgs::msg::OperatorRequest message =
      ToMessage(OperatorRequest{{}, "anna", 1, "w1", DrivingBench::Key(DriveAction::kForward)});
  message.drive(77);
  REQUIRE(raw.Publish(message));
  bench.service.Step();
  CHECK(bench.Orders().empty());
  CHECK(bench.Ask(bench.bert, DrivingBench::Key(DriveAction::kForward)).accepted);
}

}  // namespace
}  // namespace conav::operators
