#include <fmt/core.h>

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

  OperatorReply Guide() { return Ask(GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 60.0}); }
  void PassTo(std::int64_t second) {
    sim.PublishState({1, 1}, second * kSecond);
    service.Step();
  }
};

TEST_CASE("An empty queue is published before any robot reports", "[operator][integration]") {
  OperatorConfig config = ConfigFor("");
  config.attention.order = "fifo";
  OperatorBench bench(config);
  const AttentionQueueState queue = bench.sim.NewestQueue();
  CHECK(queue.items.empty());
  CHECK(queue.order == "fifo");
  CHECK(queue.workload == OperatorWorkload{});
}

TEST_CASE("Two robots' questions are in order, a robot that dies leaves a notice alone",
          "[operator][integration]") {
  OperatorConfig config = ConfigFor("");
  config.robots = {"w1/r1", "w1/r2"};
  OperatorBench bench(config);
  std::optional<HandMadeSim> r2(std::in_place, bench.bus, "r2");
  bench.sim.Begin();
  r2->PublishState({3, 1}, 5);
  for (const char* robot : {"r1", "r2"}) {
    CHECK(bench.Ask(GuideRequest{robot, {{1, 1}, {1, 2}}, 0, 600.0}).accepted);
  }
  bench.sim.Ask(AttentionReason::kBlocked, 1.0);
  r2->Ask(AttentionReason::kBlocked, 5.0);
  r2->Ask(AttentionReason::kSnapshot, 50.0, 2);
  bench.service.Step();
  const auto queue = bench.sim.NewestQueue();
  std::vector<std::pair<std::string, AttentionReason>> asking;
  for (const AttentionItem& item : queue.items) asking.emplace_back(item.robot, item.reason);
  CHECK(asking == decltype(asking){{"r2", AttentionReason::kBlocked},
                                   {"r1", AttentionReason::kBlocked},
                                   {"r2", AttentionReason::kSnapshot}});
  CHECK(bench.Ask(GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 600.0}).accepted);
  r2.reset();
  bench.service.Step();
  const auto left = bench.sim.NewestQueue();
  REQUIRE(left.items.size() == 1);
  CHECK(left.items[0].robot == "r2");
  CHECK(left.items[0].reason == AttentionReason::kLinkLost);
  CHECK(left.workload.robots == 1);
}

TEST_CASE("From the selection to the guidance is the interaction, measured in the world's time",
          "[operator][integration]") {
  AttentionBench bench;
  bench.sim.Ask(AttentionReason::kBlocked, 3.0);
  bench.PassTo(10);
  bench.PassTo(14);
  CHECK(bench.Ask(SelectRequest{"r1", AttentionReason::kBlocked}).accepted);
  CHECK(bench.sim.NewestQueue().items.at(0).selected_by == "anna");
  bench.PassTo(20);
  CHECK(bench.Ask(EditRequest{0, {{{1, 2}, true}}}).accepted);
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
  CHECK(select("cleo"));  // and the notice is gone
  CHECK(select("cleo"));
  for (int i = 0; i < 64; ++i) CHECK_FALSE(select(fmt::format("page/{}", i)));
  CHECK_FALSE(select("cleo"));
}

}  // namespace
}  // namespace conav::operators
