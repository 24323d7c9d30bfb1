#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "integration/operator/operator_bench.h"

namespace conav::operators {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// A bench whose robot r1 was guided.
struct AttentionBench : OperatorBench {
  AttentionBench() {
    sim.PublishInitialMap(kMap);
    sim.PublishState({1, 1}, kSecond);
    service.Step();
    Guide();
    sim.queue.Take();
  }

  OperatorReply Guide() {
    return Settle(client.Send("w1", GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 60.0}, {}));
  }
  OperatorReply Select(AttentionReason reason) {
    return Settle(client.Send("w1", SelectRequest{"r1", reason}, {}));
  }
  void PassTo(std::int64_t second) {
    sim.PublishState({1, 1}, second * kSecond);
    service.Step();
  }
};

TEST_CASE("An empty queue is published before any robot reports", "[operator][integration]") {
  const TemporaryFolder folder;
  const auto bus = std::make_shared<bus::InMemoryBus>();
  HandMadeSim sim(bus);
  bus::Participant participant("operator", bus);
  const FakeClock clock;
  OperatorConfig config = ConfigFor(folder / "operator.db");
  config.attention.order = "fifo";
  const OperatorService service(participant, config, clock);
  const AttentionQueueState queue = sim.NewestQueue();
  CHECK(queue.items.empty());
  CHECK(queue.order == "fifo");
  CHECK(queue.workload == OperatorWorkload{});
}

TEST_CASE("A robot's first path, and then its question, are in the queue until they are answered",
          "[operator][integration]") {
  AttentionBench bench;
  bench.sim.Ask(AttentionReason::kBlocked, 3.0);
  bench.PassTo(2);
  const AttentionQueueState queue = bench.sim.NewestQueue();
  REQUIRE(queue.items.size() == 1);
  CHECK(queue.items[0].reason == AttentionReason::kBlocked);
  CHECK(queue.items[0].since == SimTime{2 * kSecond});
  CHECK(queue.items[0].value_lost_per_s == 3.0);
  CHECK(queue.items[0].score > 0.0);
  CHECK(queue.workload.robots == 1);
  CHECK(bench.Guide().accepted);
  CHECK(bench.sim.NewestQueue().items.empty());
}

TEST_CASE("From the selection to the guidance is the interaction, measured in the world's time",
          "[operator][integration]") {
  AttentionBench bench;
  bench.sim.Ask(AttentionReason::kBlocked, 3.0);
  bench.PassTo(10);
  bench.PassTo(14);
  CHECK(bench.Select(AttentionReason::kBlocked).accepted);
  CHECK(bench.sim.NewestQueue().items.at(0).selected_by == "anna");
  bench.PassTo(20);
  CHECK(bench.Settle(bench.client.Send("w1", EditRequest{0, {{{1, 2}, true}}}, {})).accepted);
  bench.PassTo(21);
  CHECK(bench.Guide().accepted);
  const OperatorWorkload workload = bench.sim.NewestQueue().workload;
  CHECK(workload.interactions == 1);
  CHECK(workload.interaction_time_s == 7.0);
  CHECK(workload.waiting_time_s == 2.0);  // the first path was answered at once
  CHECK(workload.busy_s == 7.0);
}

TEST_CASE("A repeated selection gets its reply, until many other clients have selected something",
          "[operator][integration]") {
  AttentionBench bench;
  bus::Publisher<conav_msgs::msg::OperatorRequest> requests(bench.client_participant,
                                                            bus::kOperatorRequest);
  bus::Subscriber<conav_msgs::msg::OperatorReply> replies(bench.client_participant,
                                                          bus::kOperatorReply);
  const auto select = [&](const std::string& client) {
    const SelectRequest lost{"r1", AttentionReason::kLinkLost};
    REQUIRE(requests.Publish(ToMessage(OperatorRequest{{}, client, 1, "w1", lost})));
    bench.service.Step();
    return HandMadeSim::Newest(replies).accepted;
  };
  bench.sim.LoseRobot();
  bench.service.Step();
  CHECK(select("anna"));  // and the notice is gone
  CHECK(select("anna"));
  for (int i = 0; i < 64; ++i) CHECK_FALSE(select(fmt::format("page/{}", i)));
  CHECK_FALSE(select("anna"));
}

}  // namespace
}  // namespace conav::operators
