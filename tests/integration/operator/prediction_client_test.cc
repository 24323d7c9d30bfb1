#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/msg/convert.h"
#include "operator/console/console_topics.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

/// A client, and a perception service by hand.
struct PredictionBench {
  PredictionBench()
      : bus(std::make_shared<bus::InMemoryBus>()),
        operator_side("operator", bus),
        nhpm_side("nhpm", bus),
        client(operator_side, clock),
        requests(nhpm_side, bus::kPerceptionRequest),
        replies(nhpm_side, bus::kPredictionReply) {}

  void Reply(const conav_msgs::msg::PerceptionRequest& request, const std::string& client) {
    const PerceptionReply reply{.client = client,
                                .request_id = request.request_id(),
                                .replica = "nhpm",
                                .model = "nhpm",
                                .model_version = "1",
                                .model_checksum = std::string(64, '0'),
                                .answers = {{Grid<float>(3, 4, 0.5F), Grid<float>(3, 4, 0.25F)}}};
    REQUIRE(replies.Publish(ToMessage(reply)));
  }

  FakeClock clock;
  std::shared_ptr<bus::InMemoryBus> bus;
  bus::Participant operator_side;
  bus::Participant nhpm_side;
  PredictionClient client;
  bus::Subscriber<conav_msgs::msg::PerceptionRequest> requests;
  bus::Publisher<conav_msgs::msg::PerceptionReply> replies;
  Belief belief{.world = "w1", .revision = 4, .wall_probability = BeliefGrid(3, 4, 0.25F)};
  Snapshot snapshot{.world = "w1",
                    .robot = "r1",
                    .sequence_number = 7,
                    .cell = {1, 1},
                    .heading_rad = 1.5,
                    .visible = {{{1, 1}}, {{0, 1}}},
                    .path = {{1, 2}, {1, 1}}};
};

TEST_CASE(
    "A picture is asked about as planners ask, three times at most, and its answer reported once",
    "[operator][prediction]") {
  PredictionBench bench;
  bench.client.Ask(bench.snapshot, bench.belief);
  const auto asked = bench.requests.Take();
  REQUIRE(asked.size() == 1);
  const auto request = ToDomain(asked[0]);
  REQUIRE(request);
  REQUIRE(request->queries.size() == 1);
  CHECK(
      request->queries[0] ==
      PerceptionQuery{
          bench.belief.wall_probability, bench.snapshot.path, {1, 1}, 1.5, bench.snapshot.visible});
  CHECK(bench.client.Step().empty());
  bench.Reply(asked[0], "somebody-else");
  CHECK(bench.client.Step().empty());
  bench.Reply(asked[0], asked[0].client());
  const auto reported = bench.client.Step();
  REQUIRE(reported.size() == 1);
  CHECK(reported[0].robot == "r1");
  CHECK(reported[0].world == "w1");
  CHECK(reported[0].snapshot == 7);
  CHECK(reported[0].model == "nhpm");
  CHECK(reported[0].answer.remove == Grid<float>(3, 4, 0.25F));
  bench.Reply(asked[0], asked[0].client());
  CHECK(bench.client.Step().empty());
  PredictionBench silent;
  silent.client.Ask(silent.snapshot, silent.belief);
  silent.clock.Advance(999ms);
  silent.client.Step();
  CHECK(silent.requests.Take().size() == 1);
  for (const std::size_t more : {1U, 1U, 0U, 0U}) {
    silent.clock.Advance(1s);
    silent.client.Step();
    CHECK(silent.requests.Take().size() == more);
  }
}

TEST_CASE(
    "Of two pictures of a robot only the newer one's answer counts, beyond the map none is asked "
    "about",
    "[operator][prediction]") {
  PredictionBench bench;
  bench.client.Ask(bench.snapshot, bench.belief);
  bench.snapshot.sequence_number = 8;
  bench.client.Ask(bench.snapshot, bench.belief);
  const auto asked = bench.requests.Take();
  REQUIRE(asked.size() == 2);
  bench.Reply(asked[0], asked[0].client());
  CHECK(bench.client.Step().empty());
  bench.Reply(asked[1], asked[1].client());
  REQUIRE(bench.client.Step().size() == 1);
  bench.snapshot.visible.walls.push_back({3, 0});
  bench.client.Ask(bench.snapshot, bench.belief);
  CHECK(bench.requests.Take().empty());
}

}  // namespace
}  // namespace conav::operators
