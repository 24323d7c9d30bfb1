#include "planner/perception/remote_model.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "common/bus/in_memory_bus.h"
#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "conformance/perception_model_conformance.h"

namespace conav::planner {
namespace {

using conformance::MakeQueries;
using conformance::MakeQuery;
using RequestMessage = conav_msgs::msg::PerceptionRequest;
using ReplyMessage = conav_msgs::msg::PerceptionReply;
using std::chrono::milliseconds;

/// Replies in the test's hand: `on_request` is called inside of the asker's Publish().
class ScriptedService {
 public:
  using OnRequest = std::function<void(ScriptedService&, const RequestMessage&)>;

  ScriptedService(std::shared_ptr<bus::InMemoryBus> bus, OnRequest on_request)
      : participant_("nhpm", std::move(bus)),
        replies_(participant_, bus::kPerceptionReply),
        requests_(participant_, bus::kPerceptionRequest, {},
                  [this, on_request](RequestMessage&& message) {
                    ++asked;
                    on_request(*this, message);
                  }) {}

  void Reply(const ReplyMessage& message) { REQUIRE(replies_.Publish(message)); }

  std::atomic<int> asked{0};

 private:
  bus::Participant participant_;
  bus::Publisher<ReplyMessage> replies_;
  bus::Subscriber<RequestMessage> requests_;
};

/// A right reply: every probability is 0.5.
ReplyMessage HalfReply(const RequestMessage& request) {
  PerceptionReply reply{.client = request.client(),
                        .request_id = request.request_id(),
                        .replica = "nhpm",
                        .model = "half",
                        .model_version = "1",
                        .model_checksum = std::string(64, '5')};
  const Grid<float> half(static_cast<int>(request.rows()), static_cast<int>(request.columns()),
                         0.5F);
  for (std::size_t i = 0; i < request.queries().size(); ++i) reply.answers.push_back({half, half});
  return ToMessage(reply);
}

struct RemoteBench {
  explicit RemoteBench(ScriptedService::OnRequest on_request,
                       RemotePerceptionModel::Options options = Quick()) {
    service = std::make_unique<ScriptedService>(bus, std::move(on_request));
    model = std::make_unique<RemotePerceptionModel>(participant, options);
  }
  static RemotePerceptionModel::Options Quick() {
    return {.timeout = milliseconds(100),
            .retry_interval = milliseconds(10),
            .busy_pause = milliseconds(5)};
  }
  auto Ask() { return model->Predict(MakeQueries(2)); }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant{"planner", bus};
  std::unique_ptr<ScriptedService> service;
  std::unique_ptr<RemotePerceptionModel> model;
};

void ExpectFailure(RemoteBench& bench, ErrorCode code, const std::string& named = "") {
  const auto answers = bench.Ask();
  REQUIRE_FALSE(answers);
  CHECK(answers.error().code == code);
  CHECK_THAT(answers.error().text, Catch::Contains(named));
}

/// A reply that says only how it went.
ReplyMessage WithoutAnswers(const RequestMessage& request, std::uint8_t status,
                            const std::string& reason) {
  ReplyMessage reply = HalfReply(request);
  reply.status(status);
  reply.reason(reason);
  reply.answers().clear();
  return reply;
}

ReplyMessage BusyReply(const RequestMessage& request) {
  return WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_BUSY, "9 requests are open");
}

constexpr auto kAnswer = [](auto& service, const auto& request) {
  service.Reply(HalfReply(request));
};
constexpr auto kSilence = [](auto&, const auto&) {};

RemotePerceptionModel::Options Patient() {
  auto options = RemoteBench::Quick();
  options.timeout = std::chrono::minutes(10);
  return options;
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
  ExpectFailure(silent, ErrorCode::kTimeout, "0.1 s");
  CHECK(silent.service->asked >= 2);
}

TEST_CASE("A service that is gone is known at once, also while it is asked",
          "[planner][perception]") {
  RemoteBench bench(kAnswer, Patient());
  REQUIRE(bench.Ask());
  bench.service.reset();
  ExpectFailure(bench, ErrorCode::kUnavailable);
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
  ExpectFailure(bench, ErrorCode::kTimeout);
  ExpectFailure(bench, ErrorCode::kUnavailable);
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

TEST_CASE("The replica that answered is asked next, and all when it is silent or refuses",
          "[planner][perception]") {
  std::vector<std::string> addressed;
  const bool refuses = GENERATE(false, true);
  RemoteBench bench([&](auto& service, const auto& request) {
    addressed.push_back(request.replica());
    if (service.asked != 2) {
      service.Reply(HalfReply(request));
    } else if (refuses) {
      service.Reply(WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "no"));
    }
  });
  REQUIRE(bench.Ask());
  CHECK(bench.Ask().has_value() != refuses);
  if (refuses) REQUIRE(bench.Ask());
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

struct LogLines {
  LogLines() {
    log::SetSink([this](const log::Record& record) { all.emplace_back(record.text); });
  }
  ~LogLines() { log::SetSink(nullptr); }
  std::vector<std::string> all;
};

TEST_CASE("A service that refuses or is too busy is unavailable, with its reason",
          "[planner][perception]") {
  const std::uint8_t status =
      GENERATE(as<std::uint8_t>{}, conav_msgs::msg::PERCEPTION_STATUS_REFUSED,
               conav_msgs::msg::PERCEPTION_STATUS_BUSY);
  RemoteBench bench([&](auto& service, const auto& request) {
    service.Reply(WithoutAnswers(request, status, "9 are open"));
  });
  ExpectFailure(bench, ErrorCode::kUnavailable, "9 are open");
}

TEST_CASE("A reply that does not fit the request is refused, counted and logged",
          "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    reply.answers().pop_back();
    if (request.request_id() == 2) reply.answers()[0].add().pop_back();
    service.Reply(reply);
  });
  ExpectFailure(bench, ErrorCode::kUnavailable, "answers has size 1");
  CHECK_THAT(lines.all.at(0),
             Catch::Contains("/conav/perception/reply") && Catch::Contains("answers has size 1"));
  ExpectFailure(bench, ErrorCode::kUnavailable, "98");
  CHECK(bench.model->refused() == 2);
}

TEST_CASE("The model that answers gives its name, and is logged once and when it changes",
          "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    if (request.request_id() > 2) reply.model_checksum(std::string(64, '7'));
    service.Reply(reply);
  });
  CHECK(bench.model->identity().name == "remote");
  for (int i = 0; i < 4; ++i) CHECK(bench.Ask().value().at(1).add[{2, 2}] == 0.5F);
  CHECK(bench.model->identity().name == "half");
  CHECK(bench.service->asked == 4);
  REQUIRE(lines.all.size() == 2);
  CHECK_THAT(lines.all[0], Catch::Contains("half") && Catch::Contains(std::string(64, '5')));
  CHECK_THAT(lines.all[1], Catch::Contains(std::string(64, '7')));
}

TEST_CASE("An answer of another model or other weights than those wanted is refused",
          "[planner][perception]") {
  auto options = RemoteBench::Quick();
  const std::string other(64, '6');
  SECTION("another model, which says why") {
    options.model = "network";
    RemoteBench bench(
        [](auto& service, const auto& request) {
          CHECK(request.model() == "network");
          service.Reply(
              WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "no network"));
        },
        options);
    CHECK(bench.model->identity().name == "network");
    ExpectFailure(bench, ErrorCode::kUnavailable, "no network");
  }
  SECTION("other weights") {
    options.model_checksum = other;
    RemoteBench bench(
        [&](auto& service, const auto& request) {
          CHECK(request.model_checksum() == other);
          service.Reply(HalfReply(request));
        },
        options);
    ExpectFailure(bench, ErrorCode::kUnavailable, std::string(64, '5'));
    ExpectFailure(bench, ErrorCode::kUnavailable, other);
  }
}

TEST_CASE("A busy service is asked again after a pause, and not reported as one that is silent",
          "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(service.asked == 1 || service.asked == 4 ? HalfReply(request)
                                                           : BusyReply(request));
  });
  REQUIRE(bench.Ask());
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 4);
  CHECK(bench.model->busy() == 2);
  CHECK(bench.model->repeats() == 0);
  REQUIRE(lines.all.size() >= 2);  // the first says which model answers
  CHECK_THAT(lines.all[1], Catch::Contains("busy") && Catch::Contains("replica=nhpm"));
}

/// Two replicas, "nhpm" that answers and "bad", which gets the word first; whom each request was
/// addressed to.
struct TwoReplicas {
  explicit TwoReplicas(std::function<ReplyMessage(const RequestMessage&)> bad)
      : bench(
            [this, bad](auto& service, const auto& request) {
              addressed.push_back(request.replica());
              ReplyMessage reply = bad(request);
              reply.replica("bad");
              if (request.replica().empty() || request.replica() == "bad") service.Reply(reply);
              if (request.replica().empty() || request.replica() == "nhpm") {
                service.Reply(HalfReply(request));
              }
            },
            WantsHalf()) {}
  static RemotePerceptionModel::Options WantsHalf() {
    auto options = RemoteBench::Quick();
    options.model = "half";
    return options;
  }
  std::vector<std::string> addressed;
  RemoteBench bench;
  bus::Participant second{"bad", bench.bus};  // so that two are counted
  bus::Publisher<ReplyMessage> its_replies{second, bus::kPerceptionReply};
};

TEST_CASE("The good reply of a replica counts, whatever the others say", "[planner][perception]") {
  const auto refusing = [](const RequestMessage& request) {
    return WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "too large");
  };
  const auto unreadable = [](const RequestMessage& request) {
    ReplyMessage reply = HalfReply(request);
    reply.model_checksum(std::string(64, '7'));
    reply.answers()[0].add().pop_back();
    return reply;
  };
  const auto of_another_model = [](const RequestMessage& request) {
    ReplyMessage reply = HalfReply(request);
    reply.model("whole");
    return reply;
  };
  using Bad = std::function<ReplyMessage(const RequestMessage&)>;
  for (const Bad& bad : {Bad(refusing), Bad(unreadable), Bad(BusyReply), Bad(of_another_model)}) {
    TwoReplicas both(bad);
    REQUIRE(both.bench.Ask());
    CHECK(both.bench.model->identity() == ModelIdentity{"half", "1", std::string(64, '5')});
    REQUIRE(both.bench.Ask());
    CHECK(both.addressed == std::vector<std::string>{"", "nhpm"});
  }
}

}  // namespace
}  // namespace conav::planner
