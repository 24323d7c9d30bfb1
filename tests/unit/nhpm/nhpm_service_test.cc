#include "nhpm/nhpm_service.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <thread>

#include "common/bus/in_memory_bus.h"
#include "common/msg/convert.h"
#include "support/test_weights.h"

namespace conav::nhpm {
namespace {

using RequestMessage = conav_msgs::msg::PerceptionRequest;

/// The service and one client on an in-memory bus. Nothing is answered before AnswerOpen().
struct ServiceBench {
  explicit ServiceBench(const NhpmConfig& config = Glpfs())
      : service(service_side, config, clock) {}

  static NhpmConfig Glpfs() {
    NhpmConfig config;
    config.model = PerceptionModelKind::kGlpf;
    return config;
  }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  bus::Participant service_side{"nhpm", bus};
  bus::Participant client_side{"client", bus};
  NhpmService service;
  bus::Publisher<RequestMessage> requests{client_side, bus::kPerceptionRequest};
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies{client_side, bus::kPerceptionReply};
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health{client_side, bus::kDiagnostics};

  /// All replies to `messages` after one turn of the service.
  std::vector<PerceptionReply> Ask(const std::vector<RequestMessage>& messages) {
    Send(messages);
    service.AnswerOpen();
    return Replies();
  }

  /// The one reply to one request.
  PerceptionReply AskOne(const PerceptionRequest& request) {
    const auto answers = Ask({ToMessage(request)});
    REQUIRE(answers.size() == 1);
    return answers[0];
  }

  void Send(const std::vector<RequestMessage>& messages) {
    for (const auto& message : messages) REQUIRE(requests.Publish(message));
    service.Receive({});
  }

  std::vector<PerceptionReply> Replies() {
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
  PerceptionRequest request{.client = "planner-1", .request_id = 7, .queries = {query, query}};
  request.queries[1].belief[{1, 2}] = 1.0F;
  return request;
}

TEST_CASE("A batch is answered with the bits of the model", "[nhpm]") {
  ServiceBench bench;
  const PerceptionReply reply = bench.AskOne(SampleRequest());
  CHECK(reply.client == "planner-1");
  CHECK(reply.request_id == 7);
  CHECK(reply.status == PerceptionStatus::kOk);
  CHECK(reply.reason.empty());
  CHECK(reply.model == "glpf");
  CHECK(reply.model_version == Glpf().version());
  CHECK(reply.model_checksum == Glpf().identity().checksum);
  CHECK(reply.replica == "nhpm");
  CHECK(reply.answers == *Glpf().Predict(SampleRequest().queries));
  CHECK(bench.service.counts().requests == 1);
  CHECK(bench.service.counts().queries == 2);
}

TEST_CASE(
    "A request is answered once, alike when it is repeated after its reply, and an empty one "
    "gets an empty answer",
    "[nhpm]") {
  ServiceBench bench;
  const auto first = bench.Ask({ToMessage(SampleRequest()), ToMessage(SampleRequest())});
  REQUIRE(first.size() == 1);
  CHECK(bench.Ask({ToMessage(SampleRequest())}) == first);
  const PerceptionReply empty = bench.AskOne({.client = "c", .request_id = 1, .model = "glpf"});
  CHECK(empty.status == PerceptionStatus::kOk);
  CHECK(empty.answers.empty());
}

TEST_CASE("A request for another replica is left to that one", "[nhpm]") {
  ServiceBench bench;
  PerceptionRequest request = SampleRequest();
  request.replica = "nhpm-2";
  CHECK(bench.Ask({ToMessage(request)}).empty());
  request.replica = "nhpm";
  CHECK(bench.Ask({ToMessage(request)}).size() == 1);
}

TEST_CASE("A request for another model or other weights is refused by name", "[nhpm]") {
  ServiceBench bench;
  PerceptionRequest other_model = SampleRequest();
  other_model.model = "network";
  PerceptionRequest other_weights = SampleRequest();
  other_weights.model_checksum = std::string(64, 'a');
  for (const auto& [request, asked, served] :
       {std::tuple(other_model, std::string("'network'"), std::string("'glpf'")),
        std::tuple(other_weights, std::string(64, 'a'), Glpf().identity().checksum)}) {
    const PerceptionReply reply = bench.AskOne(request);
    CHECK(reply.status == PerceptionStatus::kRefused);
    CHECK_THAT(reply.reason, Catch::Contains(asked) && Catch::Contains(served));
    CHECK(reply.answers.empty());
  }
  CHECK(bench.service.counts().refused == 2);
  other_weights.model_checksum = Glpf().identity().checksum;
  CHECK(bench.AskOne(other_weights).status == PerceptionStatus::kOk);
}

PerceptionRequest Numbered(std::uint64_t id, std::uint32_t timeout_ms = 0) {
  PerceptionRequest request = SampleRequest();
  request.request_id = id;
  request.timeout_ms = timeout_ms;
  return request;
}

TEST_CASE("More requests than may be open are answered busy at once", "[nhpm]") {
  NhpmConfig config = ServiceBench::Glpfs();
  config.max_open = 2;
  ServiceBench bench(config);
  bench.Send({ToMessage(Numbered(1)), ToMessage(Numbered(2)), ToMessage(Numbered(3))});
  const auto busy = bench.Replies();
  REQUIRE(busy.size() == 1);
  CHECK(busy[0].request_id == 3);
  CHECK(busy[0].status == PerceptionStatus::kBusy);
  CHECK(busy[0].reason == "2 requests are open");
  CHECK(busy[0].model == "glpf");
  bench.service.AnswerOpen();
  CHECK(bench.Replies().size() == 2);
  CHECK(bench.AskOne(Numbered(3)).status == PerceptionStatus::kOk);
  CHECK(bench.service.counts().busy == 1);
  CHECK(bench.service.counts().late == 0);
}

TEST_CASE("A request whose deadline passed while it waited is not computed", "[nhpm]") {
  ServiceBench bench;
  bench.Send({ToMessage(Numbered(1, 100)), ToMessage(Numbered(2))});
  bench.clock.Advance(std::chrono::milliseconds(100));
  bench.service.AnswerOpen();
  const auto replies = bench.Replies();
  REQUIRE(replies.size() == 2);
  CHECK(replies[0].status == PerceptionStatus::kBusy);
  CHECK(replies[0].reason == "waited in the queue for more than 100 ms");
  CHECK(replies[0].answers.empty());
  CHECK(replies[1].status == PerceptionStatus::kOk);
  CHECK(bench.service.counts().late == 1);
  CHECK(bench.service.counts().requests == 1);
}

NhpmConfig Network(const std::string& weights) {
  NhpmConfig config;
  config.model = PerceptionModelKind::kNhpm;
  config.weights = weights;
  return config;
}

TEST_CASE("New weights answer from the next second on, and what was open is answered", "[nhpm]") {
  const test::WeightsFolder folder;
  const std::string file = folder.Write("default", test::UntrainedNetwork(1));
  ServiceBench bench(Network(file));
  const auto before = bench.Ask({ToMessage(Numbered(1))});
  CHECK(before.at(0).model_checksum == ChecksumOf(test::UntrainedNetwork(1)));
  bench.Send({ToMessage(Numbered(2))});
  folder.Write("default", test::UntrainedNetwork(2));
  bench.clock.Advance(std::chrono::seconds(1));
  const auto after = bench.Ask({ToMessage(Numbered(3))});
  REQUIRE(after.size() == 2);
  for (const PerceptionReply& reply : after) {
    CHECK(reply.status == PerceptionStatus::kOk);
    CHECK(reply.model_checksum == ChecksumOf(test::UntrainedNetwork(2)));
    CHECK_FALSE(reply.answers == before.at(0).answers);
  }
}

TEST_CASE("A person is answered by their own model, another grid size with a refusal", "[nhpm]") {
  const test::WeightsFolder folder;
  const test::WeightsFolder persons;
  NhpmConfig config = Network(folder.Write("default", test::UntrainedNetwork(1)));
  config.person_weights = persons.path().string();
  persons.Write("anna", test::UntrainedNetwork(2));
  persons.Write("bert", test::UntrainedNetwork(1, 13, 13));
  ServiceBench bench(config);
  PerceptionRequest request = Numbered(1);
  request.person = "anna";
  CHECK(bench.AskOne(request).model_version == "untrained 2");
  CHECK(bench.AskOne(Numbered(2)).model_version == "untrained 1");
  request.request_id = 3;
  request.person = "bert";
  const PerceptionReply refused = bench.AskOne(request);
  CHECK(refused.status == PerceptionStatus::kRefused);
  CHECK_THAT(refused.reason, Catch::Contains("13 x 13") && Catch::Contains("3 x 4"));
}

TEST_CASE("A malformed request is refused with field and value, and the next is answered",
          "[nhpm]") {
  ServiceBench bench;
  RequestMessage malformed = ToMessage(SampleRequest());
  malformed.rows(5);
  RequestMessage spoiled = ToMessage(Numbered(8));
  spoiled.queries()[1].belief()[3] = NAN;
  const auto replies = bench.Ask({malformed, spoiled, ToMessage(Numbered(9))});
  REQUIRE(replies.size() == 3);
  CHECK(replies[0].status == PerceptionStatus::kRefused);
  CHECK_THAT(replies[0].reason, Catch::StartsWith("queries[0].belief"));
  CHECK_THAT(replies[1].reason, Catch::StartsWith("queries[1].belief[3]"));
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
  std::map<std::string, std::string> values;
  for (const auto& entry : status.values()) values[entry.key()] = entry.value();
  CHECK(values.at("model_checksum") == Glpf().identity().checksum);
  CHECK(values.at("open") == "1");
  CHECK(values.at("requests") == "0");
  CHECK(values.at("busy") == "0");
  bench.clock.Advance(std::chrono::milliseconds(900));
  bench.service.Receive({});
  CHECK(bench.health.Take().empty());
  bench.clock.Advance(std::chrono::milliseconds(100));
  bench.service.Receive({});
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

using std::chrono::milliseconds;
using Admission = RequestQueue::Admission;

/// About a grid of `cells`.
OpenRequest Request(std::uint64_t id, int cells = 1, std::uint32_t timeout_ms = 0) {
  OpenRequest open;
  open.request.client = "planner-1";
  open.request.request_id = id;
  open.request.timeout_ms = timeout_ms;
  open.request.queries.resize(1);
  open.request.queries[0].belief = BeliefGrid(1, cells, 0.5F);
  return open;
}

/// A queue that knows what a cell costs: 10 ms.
struct Experienced {
  explicit Experienced(int threads = 1) : queue(100, threads) {
    queue.Offer(Request(1000));
    queue.Finish(*queue.Take(), milliseconds(10));
  }
  RequestQueue queue;
};

TEST_CASE("Requests are taken in the order in which they came", "[queue]") {
  RequestQueue queue(4, 1);
  CHECK_FALSE(queue.Take());
  CHECK(queue.Offer(Request(1)) == Admission::kQueued);
  CHECK(queue.Offer(Request(2)) == Admission::kQueued);
  CHECK(queue.Take()->request.request_id == 1);
  CHECK(queue.Take()->request.request_id == 2);
  CHECK_FALSE(queue.Take());
}

TEST_CASE("A queue is full when its requests wait or are computed, and not after them", "[queue]") {
  RequestQueue queue(2, 1);
  queue.Offer(Request(1));
  queue.Offer(Request(2));
  const auto first = queue.Take();
  CHECK(queue.open() == 2);
  OpenRequest third = Request(3);
  CHECK(queue.Offer(std::move(third)) == Admission::kFull);
  CHECK(third.request.request_id == 3);  // still there, to be replied to
  queue.Finish(*first, milliseconds(1));
  CHECK(queue.Offer(std::move(third)) == Admission::kQueued);
}

TEST_CASE("A request that is open already is not taken twice", "[queue]") {
  RequestQueue queue(4, 1);
  queue.Offer(Request(1));
  CHECK(queue.Offer(Request(1)) == Admission::kRepeat);
  const auto taken = queue.Take();
  CHECK(queue.Offer(Request(1)) == Admission::kRepeat);  // while it is computed
  CHECK_FALSE(queue.Take());
  queue.Finish(*taken, milliseconds(1));
  CHECK(queue.Offer(Request(1)) == Admission::kQueued);  // answered: once more, alike
  OpenRequest other = Request(1);
  other.request.client = "planner-2";
  CHECK(queue.Offer(std::move(other)) == Admission::kQueued);
}

TEST_CASE("A repeat lends its later deadline to the request that waits", "[queue]") {
  RequestQueue queue(4, 1);
  queue.Offer(Request(1, 1, 100));
  OpenRequest repeat = Request(1, 1, 70);
  repeat.arrived += milliseconds(60);
  queue.Offer(std::move(repeat));
  CHECK(queue.Take()->deadline() == Clock::TimePoint{} + milliseconds(130));
}

TEST_CASE("A request that would miss its deadline is not queued, once a cell's cost is known",
          "[queue]") {
  CHECK_FALSE(Request(1).deadline());  // it names no timeout
  RequestQueue fresh(4, 1);
  CHECK(fresh.Offer(Request(1, 1000, 1)) == Admission::kQueued);
  Experienced bench;
  CHECK(bench.queue.Offer(Request(1, 3, 30)) == Admission::kQueued);
  CHECK(bench.queue.ExpectedWait(1) == milliseconds(40));
  CHECK(bench.queue.Offer(Request(2, 1, 39)) == Admission::kTooSlow);
  CHECK(bench.queue.Offer(Request(2, 1, 40)) == Admission::kQueued);
  CHECK(bench.queue.Offer(Request(3, 100)) == Admission::kQueued);  // it does not say
}

TEST_CASE("A slow answer turns nobody away while nothing is open", "[queue]") {
  Experienced bench;
  CHECK(bench.queue.Offer(Request(1, 1, 5)) == Admission::kQueued);
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kTooSlow);
  const auto taken = bench.queue.Take();
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kTooSlow);  // while 1 is computed
  bench.queue.Finish(*taken, milliseconds(10));
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kQueued);
}

TEST_CASE(
    "A request costs the cells of all its queries, and more threads share what is ahead, but one "
    "computes a request",
    "[queue]") {
  OpenRequest open = Request(1, 12);
  open.request.queries.push_back(open.request.queries[0]);
  CHECK(open.cells() == 24);
  Experienced bench(2);
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(40));
  bench.queue.Offer(Request(1, 6));
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(70));
}

TEST_CASE("A request that was not computed does not change the expected time", "[queue]") {
  Experienced bench;
  bench.queue.Offer(Request(1));
  bench.queue.Finish(*bench.queue.Take(), std::nullopt);
  CHECK(bench.queue.ExpectedWait(1) == milliseconds(10));
  CHECK(bench.queue.open() == 0);
}

TEST_CASE("A waiting thread gets the request that comes, a closed queue gives what is left",
          "[queue]") {
  RequestQueue queue(4, 1);
  std::optional<OpenRequest> taken;
  std::thread worker([&] { taken = queue.WaitAndTake(); });
  queue.Offer(Request(7));
  worker.join();
  REQUIRE(taken);
  CHECK(taken->request.request_id == 7);
  queue.Offer(Request(8));
  queue.Close();
  CHECK(queue.WaitAndTake()->request.request_id == 8);
  CHECK_FALSE(queue.WaitAndTake());
}

}  // namespace
}  // namespace conav::nhpm
