#include "nhpm/nhpm_service.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/bus/in_memory_bus.h"
#include "common/protocol/convert.h"

namespace conav::nhpm {
namespace {

using RequestMessage = conav_msgs::msg::PerceptionRequest;

/// The service and one client on an in-memory bus.
struct ServiceBench {
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  bus::Participant service_side{"nhpm", bus};
  bus::Participant client_side{"client", bus};
  NhpmService service{service_side, NhpmConfig{}, clock};
  bus::Publisher<RequestMessage> requests{client_side, bus::kPerceptionRequest};
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies{client_side, bus::kPerceptionReply};
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health{client_side, bus::kDiagnostics};

  /// All replies to `messages` after one turn of the service.
  std::vector<PerceptionReply> Ask(const std::vector<RequestMessage>& messages) {
    for (const auto& message : messages) REQUIRE(requests.Publish(message));
    service.RunOnce({});
    std::vector<PerceptionReply> taken;
    for (const auto& message : replies.Take()) {
      auto reply = ToDomain(message, 3, 4);
      REQUIRE(reply);
      taken.push_back(*std::move(reply));
    }
    return taken;
  }
};

PerceptionRequest SampleRequest() {
  PerceptionQuery query;
  query.belief = BeliefGrid(3, 4, 0.25F);
  query.cell = {1, 1};
  query.path = {{1, 1}};
  query.visible = {{{1, 1}}, {{1, 2}}};
  PerceptionRequest request{"planner-1", 7, "", {query, query}};
  request.queries[1].belief[{1, 2}] = 1.0F;
  return request;
}

TEST_CASE("A batch is answered with the bits of the model", "[nhpm]") {
  ServiceBench bench;
  const auto replies = bench.Ask({ToMessage(SampleRequest())});
  REQUIRE(replies.size() == 1);
  CHECK(replies[0].client == "planner-1");
  CHECK(replies[0].request_id == 7);
  CHECK(replies[0].status == PerceptionStatus::kOk);
  CHECK(replies[0].reason.empty());
  CHECK(replies[0].model == "glpf");
  CHECK(replies[0].model_version == Glpf().version());
  CHECK(replies[0].answers == *Glpf().Predict(SampleRequest().queries));
  CHECK(bench.service.counts().requests == 1);
  CHECK(bench.service.counts().queries == 2);
}

TEST_CASE("A repeated request gets a repeated reply", "[nhpm]") {
  ServiceBench bench;
  const auto replies = bench.Ask({ToMessage(SampleRequest()), ToMessage(SampleRequest())});
  REQUIRE(replies.size() == 2);
  CHECK(replies[0] == replies[1]);
}

TEST_CASE("An empty batch gets an empty answer", "[nhpm]") {
  ServiceBench bench;
  const auto replies = bench.Ask({ToMessage(PerceptionRequest{"c", 1, "glpf", {}})});
  REQUIRE(replies.size() == 1);
  CHECK(replies[0].status == PerceptionStatus::kOk);
  CHECK(replies[0].answers.empty());
}

TEST_CASE("A request for another model is refused by name", "[nhpm]") {
  ServiceBench bench;
  PerceptionRequest request = SampleRequest();
  request.model = "network";
  const auto replies = bench.Ask({ToMessage(request)});
  REQUIRE(replies.size() == 1);
  CHECK(replies[0].status == PerceptionStatus::kRefused);
  CHECK(replies[0].reason == "model = 'network' is not served here, 'glpf' is");
  CHECK(replies[0].answers.empty());
  CHECK(bench.service.counts().refused == 1);
}

TEST_CASE("A malformed request is refused with field and value, and the next is answered",
          "[nhpm]") {
  ServiceBench bench;
  RequestMessage malformed = ToMessage(SampleRequest());
  malformed.rows(5);
  RequestMessage spoiled = ToMessage(SampleRequest());
  spoiled.queries()[1].belief()[3] = NAN;
  const auto replies = bench.Ask({malformed, spoiled, ToMessage(SampleRequest())});
  REQUIRE(replies.size() == 3);
  CHECK(replies[0].status == PerceptionStatus::kRefused);
  CHECK(replies[0].reason == "queries[0].belief has size 12, not 5 x 4");
  CHECK(replies[1].reason == "queries[1].belief[3] = nan is not in [0, 1]");
  CHECK(replies[2].status == PerceptionStatus::kOk);
}

TEST_CASE("A request that does not name its sender is counted and dropped", "[nhpm]") {
  ServiceBench bench;
  RequestMessage nameless = ToMessage(SampleRequest());
  nameless.client("");
  RequestMessage unnumbered = ToMessage(SampleRequest());
  unnumbered.request_id(0);
  CHECK(bench.Ask({nameless, unnumbered}).empty());
  CHECK(bench.service.counts().dropped == 2);
}

TEST_CASE("Health is published once per second with the counts", "[nhpm]") {
  ServiceBench bench;
  bench.clock.Advance(std::chrono::seconds(1));
  bench.Ask({ToMessage(SampleRequest())});
  const auto first = bench.health.Take();
  REQUIRE(first.size() == 1);
  const auto& status = first[0].status().at(0);
  CHECK(status.level() == 0);
  CHECK(status.message() == "serving glpf");
  CHECK(status.values().at(2).key() == "requests");
  CHECK(status.values().at(2).value() == "1");
  bench.clock.Advance(std::chrono::milliseconds(900));
  bench.service.RunOnce({});
  CHECK(bench.health.Take().empty());
  bench.clock.Advance(std::chrono::milliseconds(100));
  bench.service.RunOnce({});
  CHECK(bench.health.Take().size() == 1);
}

TEST_CASE("The service's config reads back what it writes, and refuses other models", "[nhpm]") {
  NhpmConfig config;
  config.name = "nhpm_2";
  config.glpf.beta = 12.0;
  const YAML::Node document = YAML::Load(DumpConfig("nhpm", config));
  NhpmConfig read;
  ReadConfig(document["nhpm"]["ros__parameters"], "nhpm", read);
  CHECK(read.name == "nhpm_2");
  CHECK(read.glpf.beta == 12.0);
  CHECK_THROWS_AS(ReadConfig(YAML::Load("{model: oracle}"), "nhpm", read), StartupError);
}

}  // namespace
}  // namespace conav::nhpm
