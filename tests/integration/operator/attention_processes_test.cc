// The attention queue of a real conav-operator on real DDS, seen by a client as a console would.
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <functional>

#include "common/runtime/text.h"
#include "integration/operator/hand_made_sim.h"
#include "operator/simulated/operator_client.h"
#include "support/loopback.h"
#include "support/service_process.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kSecond = 1'000'000'000;

/// A robot with simulator and planner, by hand.
struct HandMadeRobot {
  HandMadeRobot(const bus::ParticipantOptions& options, std::string name)
      : name(std::move(name)),
        participant("robot", options),
        state(participant, bus::kRobotState, this->name),
        attention(participant, bus::kAttention, this->name) {}

  void PublishState(std::int64_t second) {
    RobotState now;
    now.stamp = {second * kSecond};
    now.world = "w1";
    now.robot = name;
    now.cell = {1, 1};
    now.goals_left = {{1, 4}};
    now.goals_total = 1;
    REQUIRE(state.Publish(ToMessage(now)));
  }
  void Ask(AttentionReason reason, double value_lost_per_s) {
    AttentionRequest request;
    request.world = "w1";
    request.robot = name;
    request.sequence_number = ++asked;
    request.reason = reason;
    request.value_lost_per_s = value_lost_per_s;
    REQUIRE(attention.Publish(ToMessage(request)));
  }

  std::string name;
  bus::Participant participant;
  bus::Publisher<conav_msgs::msg::RobotState> state;
  bus::Publisher<conav_msgs::msg::AttentionRequest> attention;
  std::uint64_t asked = 0;
};

/// The operator's client, with the queue as it last received it.
struct Console {
  explicit Console(const bus::ParticipantOptions& options)
      : participant("console", options),
        client(participant, clock, {"console-" + UniqueId(), 0.25, 10.0}),
        queue(participant, bus::kAttentionQueue) {}

  AttentionQueueState WaitFor(const std::function<bool(const AttentionQueueState&)>& wanted) {
    const auto deadline = clock.Now() + 20s;
    AttentionQueueState newest;
    while (clock.Now() < deadline) {
      for (const auto& message : queue.Take()) {
        newest = *ToDomain(message);
        if (wanted(newest)) return newest;
      }
      participant.Wait(100ms);
    }
    FAIL("not seen within 20 s; the newest queue has " << newest.items.size() << " items");
    return {};
  }
  template <class Request>
  bool Send(const Request& request) {
    client.Send("w1", request, {});
    const auto deadline = clock.Now() + 20s;
    while (clock.Now() < deadline) {
      for (const auto& outcome : client.Poll()) return outcome.reply && outcome.reply->accepted;
      participant.Wait(100ms);
    }
    return false;
  }

  SteadyClock clock;
  bus::Participant participant;
  OperatorClient client;
  bus::Subscriber<conav_msgs::msg::AttentionQueue> queue;
};

bool Asks(const AttentionQueueState& queue, std::size_t place, const std::string& robot,
          AttentionReason reason) {
  return queue.items.size() > place && queue.items[place].robot == robot &&
         queue.items[place].reason == reason;
}

TEST_CASE("Over DDS: the order, a measured selection, and a robot that dies leaves the queue",
          "[operator][integration]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const TemporaryFolder folder;
  OperatorConfig config = ConfigFor(folder / "operator.db");
  config.bus = test::OnLoopback(vendor);
  config.robots = {"w1/r1", "w1/r2"};
  std::ofstream(folder / "operator.yaml") << DumpConfig("operator", config);
  test::ServiceProcess service("conav-operator", folder / "operator.yaml");

  HandMadeSim sim(test::OnLoopback(vendor));  // world and r1
  std::optional<HandMadeRobot> r2(std::in_place, test::OnLoopback(vendor), "r2");
  Console console(test::OnLoopback(vendor));
  sim.PublishInitialMap(kMap);
  sim.PublishState({1, 1}, 10 * kSecond);
  r2->PublishState(10);
  console.WaitFor([](const auto& queue) { return queue.items.size() == 2; });
  REQUIRE(console.Send(GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 600.0}));
  REQUIRE(console.Send(GuideRequest{"r2", {{1, 1}, {1, 2}}, 0, 600.0}));
  console.WaitFor([](const auto& queue) { return queue.items.empty(); });

  sim.Ask(AttentionReason::kBlocked, 1.0);
  r2->Ask(AttentionReason::kBlocked, 5.0);
  r2->Ask(AttentionReason::kSnapshot, 50.0);
  console.WaitFor([](const auto& queue) {
    return Asks(queue, 0, "r2", AttentionReason::kBlocked) &&
           Asks(queue, 1, "r1", AttentionReason::kBlocked) &&
           Asks(queue, 2, "r2", AttentionReason::kSnapshot);
  });

  REQUIRE(console.Send(SelectRequest{"r1", AttentionReason::kBlocked}));
  console.WaitFor([&](const auto& queue) {
    return std::ranges::any_of(queue.items, [&](const AttentionItem& item) {
      return item.robot == "r1" && item.selected_by == console.client.name();
    });
  });
  sim.PublishState({1, 1}, 17 * kSecond);
  r2->PublishState(17);
  console.WaitFor([](const auto& queue) { return queue.stamp >= SimTime{17 * kSecond}; });
  REQUIRE(console.Send(GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 600.0}));
  const AttentionQueueState answered =
      console.WaitFor([](const auto& queue) { return queue.workload.interactions == 1; });
  CHECK(answered.workload.interaction_time_s == 7.0);
  CHECK(Asks(answered, 0, "r2", AttentionReason::kBlocked));

  r2.reset();
  const AttentionQueueState left = console.WaitFor([](const auto& queue) {
    return queue.items.size() == 1 && Asks(queue, 0, "r2", AttentionReason::kLinkLost);
  });
  CHECK(left.workload.robots == 1);
  CHECK(service.End(SIGTERM).exit_code == 0);
}

}  // namespace
}  // namespace conav::operators
