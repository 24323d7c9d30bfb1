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
  explicit ServiceBench(const NhpmConfig& config = {.model = PerceptionModelKind::kGlpf})
      : service(service_side, config, clock) {}

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

PerceptionRequest SampleRequest(std::uint64_t id = 7, std::uint32_t timeout_ms = 0) {
  PerceptionQuery query;
  query.belief = BeliefGrid(3, 4, 0.25F);
  query.cell = {1, 1};
  query.path = {{1, 1}};
  query.visible = {{{1, 1}}, {{1, 2}}};
  PerceptionRequest request{
      .client = "planner-1", .request_id = id, .timeout_ms = timeout_ms, .queries = {query, query}};
  request.queries[1].belief[{1, 2}] = 1.0F;
  return request;
}

TEST_CASE("Consoles get their replies on a topic of their own", "[nhpm]") {
  ServiceBench bench;
  bus::Subscriber<conav_msgs::msg::PerceptionReply> predictions{bench.client_side,
                                                                bus::kPredictionReply};
  PerceptionRequest request = SampleRequest();
  request.client = std::string(bus::kConsoleClient) + "1";
  CHECK(bench.Ask({ToMessage(request)}).empty());
  const auto taken = predictions.Take();
  REQUIRE(taken.size() == 1);
  CHECK(taken[0].client() == request.client);
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

TEST_CASE("A request is answered once, and alike when it is repeated, by the replica that it names",
          "[nhpm]") {
  ServiceBench bench;
  const auto first = bench.Ask({ToMessage(SampleRequest()), ToMessage(SampleRequest())});
  REQUIRE(first.size() == 1);
  PerceptionRequest repeat = SampleRequest();
  repeat.replica = "nhpm-2";
  CHECK(bench.Ask({ToMessage(repeat)}).empty());
  repeat.replica = "nhpm";
  CHECK(bench.Ask({ToMessage(repeat)}) == first);
  const PerceptionReply empty = bench.AskOne({.client = "c", .request_id = 1, .model = "glpf"});
  CHECK(empty.status == PerceptionStatus::kOk);
  CHECK(empty.answers.empty());
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

TEST_CASE("More requests than may be open are answered busy at once", "[nhpm]") {
  ServiceBench bench({.model = PerceptionModelKind::kGlpf, .max_open = 2});
  bench.Send(
      {ToMessage(SampleRequest(1)), ToMessage(SampleRequest(2)), ToMessage(SampleRequest(3))});
  const auto busy = bench.Replies();
  REQUIRE(busy.size() == 1);
  CHECK(busy[0].request_id == 3);
  CHECK(busy[0].status == PerceptionStatus::kBusy);
  CHECK_THAT(busy[0].reason, Catch::Contains("2"));
  CHECK(busy[0].model == "glpf");
  bench.service.AnswerOpen();
  CHECK(bench.Replies().size() == 2);
  CHECK(bench.AskOne(SampleRequest(3)).status == PerceptionStatus::kOk);
  CHECK(bench.service.counts().busy == 1);
  CHECK(bench.service.counts().late == 0);
}

TEST_CASE("A request whose deadline passed while it waited is not computed", "[nhpm]") {
  ServiceBench bench;
  bench.Send({ToMessage(SampleRequest(1, 100)), ToMessage(SampleRequest(2))});
  bench.clock.Advance(std::chrono::milliseconds(100));
  bench.service.AnswerOpen();
  const auto replies = bench.Replies();
  REQUIRE(replies.size() == 2);
  CHECK(replies[0].status == PerceptionStatus::kBusy);
  CHECK_THAT(replies[0].reason, Catch::Contains("100 ms"));
  CHECK(replies[0].answers.empty());
  CHECK(replies[1].status == PerceptionStatus::kOk);
  CHECK(bench.service.counts().late == 1);
  CHECK(bench.service.counts().requests == 1);
}

TEST_CASE("A person is answered by their own model, another grid size with a refusal", "[nhpm]") {
  const test::WeightsFolder folder;
  const test::WeightsFolder persons;
  persons.Write("anna", test::UntrainedNetwork(2));
  persons.Write("bert", test::UntrainedNetwork(1, 13, 13));
  ServiceBench bench({.weights = folder.Write("default", test::UntrainedNetwork(1)),
                      .person_weights = persons.path().string()});
  PerceptionRequest request = SampleRequest(1);
  request.person = "anna";
  CHECK(bench.AskOne(request).model_version == "untrained 2");
  CHECK(bench.AskOne(SampleRequest(2)).model_version == "untrained 1");
  request.request_id = 3;
  request.person = "bert";
  const PerceptionReply refused = bench.AskOne(request);
  CHECK(refused.status == PerceptionStatus::kRefused);
  CHECK_THAT(refused.reason, Catch::Contains("13 x 13") && Catch::Contains("3 x 4"));
}

TEST_CASE(
    "A malformed request is refused by field, one without a sender dropped, the next answered",
    "[nhpm]") {
  ServiceBench bench;
  RequestMessage malformed = ToMessage(SampleRequest());
  malformed.rows(5);
  RequestMessage spoiled = ToMessage(SampleRequest(8));
  spoiled.queries()[1].belief()[3] = NAN;
  RequestMessage nameless = ToMessage(SampleRequest());
  nameless.client("");
  const auto replies = bench.Ask(
      {malformed, spoiled, nameless, ToMessage(SampleRequest(0)), ToMessage(SampleRequest(9))});
  REQUIRE(replies.size() == 3);
  CHECK(replies[0].status == PerceptionStatus::kRefused);
  CHECK_THAT(replies[0].reason, Catch::StartsWith("queries[0].belief"));
  CHECK_THAT(replies[1].reason, Catch::StartsWith("queries[1].belief[3]"));
  CHECK(replies[2].status == PerceptionStatus::kOk);
  CHECK(bench.service.counts().dropped == 2);
}

TEST_CASE("Health is published twice a second with the counts", "[nhpm]") {
  ServiceBench bench;
  bench.clock.Advance(std::chrono::seconds(1));
  bench.Ask({ToMessage(SampleRequest())});
  const auto first = bench.health.Take();
  REQUIRE(first.size() == 1);
  const auto& status = first[0].status().at(0);
  CHECK(status.level() == 0);
  CHECK_THAT(status.message(), Catch::Contains("glpf"));
  std::map<std::string, std::string> values;
  for (const auto& entry : status.values()) values[entry.key()] = entry.value();
  CHECK(values.at("model_checksum") == Glpf().identity().checksum);
  CHECK(values.at("open") == "1");
  CHECK(values.at("requests") == "0");
  CHECK(values.at("busy") == "0");
  bench.clock.Advance(std::chrono::milliseconds(400));
  bench.service.Receive({});
  CHECK(bench.health.Take().empty());
  bench.clock.Advance(std::chrono::milliseconds(100));
  bench.service.Receive({});
  CHECK(bench.health.Take().size() == 1);
}

using std::chrono::milliseconds;
using Admission = RequestQueue::Admission;

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

TEST_CASE("Requests are taken in their order, a queue is full while they wait or are computed",
          "[queue]") {
  RequestQueue queue(2, 1);
  CHECK_FALSE(queue.Take());
  queue.Offer(Request(1));
  queue.Offer(Request(2));
  const auto first = queue.Take();
  CHECK(first->request.request_id == 1);
  CHECK(queue.open() == 2);
  OpenRequest third = Request(3);
  CHECK(queue.Offer(std::move(third)) == Admission::kFull);
  CHECK(third.request.request_id == 3);  // still there, to be replied to
  queue.Finish(*first, milliseconds(1));
  CHECK(queue.Offer(std::move(third)) == Admission::kQueued);
  CHECK(queue.Take()->request.request_id == 2);
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
  Experienced idle;  // a slow answer turns nobody away while nothing is open
  CHECK(idle.queue.Offer(Request(1, 1, 5)) == Admission::kQueued);
  const auto taken = idle.queue.Take();
  CHECK(idle.queue.Offer(Request(2, 1, 5)) == Admission::kTooSlow);  // while 1 is computed
  idle.queue.Finish(*taken, milliseconds(10));
  CHECK(idle.queue.Offer(Request(2, 1, 5)) == Admission::kQueued);
}

TEST_CASE(
    "A request costs the cells of all its queries, and more threads share what is ahead, but one "
    "computes a request",
    "[queue]") {
  OpenRequest open = Request(1, 12);
  open.request.queries.push_back(open.request.queries[0]);
  CHECK(open.cells() == 24);
  Experienced bench(2);
  bench.queue.Offer(Request(1));
  bench.queue.Finish(*bench.queue.Take(), std::nullopt);  // not computed: nothing is learned
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(40));
  bench.queue.Offer(Request(1, 6));
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(70));
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
