#include <catch2/catch.hpp>
#include <future>

#include "planner/perception/remote_model.h"
#include "unit/planner/perception/scripted_service.h"

namespace conav::planner {
namespace {

using namespace tests;

constexpr auto kAnswer = [](auto& service, const auto& request) {
  service.Reply(HalfReply(request));
};
constexpr auto kSilence = [](auto&, const auto&) {};

RemotePerceptionModel::Options Patient() {
  auto options = RemoteBench::Quick();
  options.timeout = std::chrono::minutes(10);
  return options;
}

TEST_CASE("The model that replied gives its name", "[planner][perception]") {
  RemoteBench bench(kAnswer);
  CHECK(bench.model->identity().name == "remote");
  const auto answers = bench.Ask();
  REQUIRE(answers);
  CHECK(answers->at(1).add[{2, 2}] == 0.5F);
  CHECK(bench.model->identity().name == "half");
  CHECK(bench.service->asked == 1);
}

TEST_CASE("A request is repeated until it is answered, or it is a timeout",
          "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    if (service.asked >= 3) service.Reply(HalfReply(request));
  });
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 3);
  CHECK(bench.model->repeats() == 2);
  RemoteBench silent(kSilence);
  ExpectFailure(silent, ErrorCode::kTimeout, "no reply of a perception service within 0.1 s");
  CHECK(silent.service->asked >= 2);
}

TEST_CASE("A service that is gone is known at once, also while it is asked",
          "[planner][perception]") {
  RemoteBench bench(kAnswer, Patient());
  REQUIRE(bench.Ask());
  bench.service.reset();
  ExpectFailure(bench, ErrorCode::kUnavailable, "no perception service is on the bus");
  std::promise<void> asked;
  RemoteBench goes(
      [&asked](auto& service, const auto&) {
        if (service.asked == 1) asked.set_value();
      },
      Patient());
  auto answers = std::async(std::launch::async, [&goes] { return goes.Ask(); });
  asked.get_future().wait();
  goes.service.reset();
  CHECK(answers.get().error().code == ErrorCode::kUnavailable);
}

TEST_CASE("A service that was never there is waited for only once", "[planner][perception]") {
  RemoteBench bench(kSilence);
  bench.service.reset();
  ExpectFailure(bench, ErrorCode::kTimeout, "no reply of a perception service within 0.1 s");
  ExpectFailure(bench, ErrorCode::kUnavailable, "no perception service is on the bus");
}

TEST_CASE("A service that comes late answers the repeated request", "[planner][perception]") {
  RemoteBench bench(kSilence, Patient());
  bench.service.reset();
  auto answers = std::async(std::launch::async, [&bench] { return bench.Ask(); });
  bench.service = std::make_unique<ScriptedService>(bench.bus, kAnswer);
  CHECK(answers.get());
}

TEST_CASE("Replies to others and to older requests are ignored", "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage foreign = HalfReply(request);
    foreign.client("somebody_else");
    foreign.answers().clear();
    service.Reply(foreign);
    ReplyMessage old = HalfReply(request);
    old.request_id(request.request_id() + 100);
    old.answers().clear();
    service.Reply(old);
    service.Reply(HalfReply(request));
    ReplyMessage second = HalfReply(request);
    second.answers().clear();
    service.Reply(second);
  });
  CHECK(bench.Ask());
}

TEST_CASE("A batch of several shapes and of very many queries is split and put together again",
          "[planner][perception]") {
  RemoteBench bench(kAnswer,
                    {.timeout = std::chrono::seconds(60), .retry_interval = milliseconds(500)});
  std::vector<PerceptionQuery> queries(300, MakeQuery(1));
  queries.push_back(MakeQuery(2, 7, 8));
  queries.push_back(MakeQuery(3));
  const auto answers = bench.model->Predict(queries);
  REQUIRE(answers);
  REQUIRE(answers->size() == 302);
  CHECK(answers->at(300).add.rows() == 7);
  CHECK(answers->at(301).add.columns() == 11);
  CHECK(bench.service->asked == 4);
}

TEST_CASE("A request says whose edits are wanted, and for how long the answer is of use",
          "[planner][perception]") {
  std::vector<std::uint32_t> timeouts_ms;
  auto options = RemoteBench::Quick();
  options.person = "anna";
  RemoteBench bench(
      [&timeouts_ms](auto& service, const auto& request) {
        CHECK(request.person() == "anna");
        timeouts_ms.push_back(request.timeout_ms());
        if (service.asked == 2) service.Reply(HalfReply(request));
      },
      options);
  REQUIRE(bench.Ask());
  REQUIRE(timeouts_ms.size() == 2);
  CHECK(timeouts_ms[0] <= 100);
  CHECK(timeouts_ms[0] > 0);
  CHECK(timeouts_ms[1] < timeouts_ms[0]);
}

TEST_CASE("The replica that answered is asked next, and all when it does not answer",
          "[planner][perception]") {
  std::vector<std::string> addressed;
  RemoteBench bench([&addressed](auto& service, const auto& request) {
    addressed.push_back(request.replica());
    if (service.asked != 2) service.Reply(HalfReply(request));
  });
  REQUIRE(bench.Ask());
  REQUIRE(bench.Ask());
  CHECK(addressed == std::vector<std::string>{"", "nhpm", ""});
}

TEST_CASE("Two models of one participant have names of their own", "[planner][perception]") {
  std::vector<std::string> clients;
  RemoteBench bench([&clients](auto& service, const auto& request) {
    clients.push_back(request.client());
    service.Reply(HalfReply(request));
  });
  RemotePerceptionModel other(bench.participant, RemoteBench::Quick());
  REQUIRE(bench.Ask());
  REQUIRE(other.Predict(MakeQueries(1)));
  REQUIRE(clients.size() == 2);
  CHECK(clients[0].starts_with("planner-"));
  CHECK(clients[0] != clients[1]);
}

}  // namespace
}  // namespace conav::planner
