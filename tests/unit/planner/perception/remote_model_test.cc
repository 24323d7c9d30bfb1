#include "planner/perception/remote_model.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "common/bus/in_memory_bus.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "conformance/perception_model_conformance.h"

namespace conav::planner {
namespace {

using conformance::MakeQueries;
using conformance::MakeQuery;
using RequestMessage = conav_msgs::msg::PerceptionRequest;
using ReplyMessage = conav_msgs::msg::PerceptionReply;
using Replies = std::vector<ReplyMessage>;
using Spoil = std::function<void(ReplyMessage&)>;
using std::chrono::milliseconds;

/// Replies as the test says: `on_request` is called inside of the asker's Publish(), with the number
/// of requests so far.
class ScriptedService {
 public:
  using OnRequest = std::function<Replies(int asked, const RequestMessage&)>;

  ScriptedService(std::shared_ptr<bus::InMemoryBus> bus, OnRequest on_request)
      : participant_("nhpm", std::move(bus)),
        replies_(participant_, bus::kPerceptionReply),
        requests_(participant_, bus::kPerceptionRequest, {},
                  [this, on_request](RequestMessage&& message) {
                    for (const auto& reply : on_request(++asked, message)) {
                      REQUIRE(replies_.Publish(reply));
                    }
                  }) {}

  std::atomic<int> asked{0};

 private:
  bus::Participant participant_;
  bus::Publisher<ReplyMessage> replies_;
  bus::Subscriber<RequestMessage> requests_;
};

/// A right reply, in which every probability is 0.5, but for what `spoil` does to it.
ReplyMessage HalfReply(
    const RequestMessage& request, const Spoil& spoil = [](ReplyMessage&) {}) {
  PerceptionReply reply{.client = request.client(),
                        .request_id = request.request_id(),
                        .replica = "nhpm",
                        .model = "half",
                        .model_version = "1",
                        .model_checksum = std::string(64, '5')};
  const Grid<float> half(static_cast<int>(request.rows()), static_cast<int>(request.columns()),
                         0.5F);
  for (std::size_t i = 0; i < request.queries().size(); ++i) reply.answers.push_back({half, half});
  ReplyMessage message = ToMessage(reply);
  spoil(message);
  return message;
}

void HasNoAnswers(ReplyMessage& reply) { reply.answers().clear(); }
void LacksACell(ReplyMessage& reply) { reply.answers()[0].add().pop_back(); }
void SaysNo(ReplyMessage& reply, std::uint8_t status) {
  HasNoAnswers(reply);
  reply.status(status);
  reply.reason("9 are open");
}
void IsBusy(ReplyMessage& reply) {
  SaysNo(reply, conav_msgs::msg::PerceptionReply_Constants::PERCEPTION_STATUS_BUSY);
}
void Refuses(ReplyMessage& reply) {
  SaysNo(reply, conav_msgs::msg::PerceptionReply_Constants::PERCEPTION_STATUS_REFUSED);
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
  static RemotePerceptionModel::Options Patient() {
    auto options = Quick();
    options.timeout = std::chrono::minutes(10);
    return options;
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

constexpr auto kAnswer = [](int, const auto& request) { return Replies{HalfReply(request)}; };
constexpr auto kSilence = [](int, const auto&) { return Replies{}; };

TEST_CASE("A request is repeated until it is answered, or it is a timeout",
          "[planner][perception]") {
  RemoteBench bench([](int asked, const auto& request) {
    return asked < 3 ? Replies{} : Replies{HalfReply(request)};
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
  RemoteBench bench(kAnswer, RemoteBench::Patient());
  REQUIRE(bench.Ask());
  bench.service.reset();
  ExpectFailure(bench, ErrorCode::kUnavailable);
  std::promise<void> was_asked;
  RemoteBench goes(
      [&was_asked](int asked, const auto&) {
        if (asked == 1) was_asked.set_value();
        return Replies{};
      },
      RemoteBench::Patient());
  auto answers = std::async(std::launch::async, [&goes] { return goes.Ask(); });
  was_asked.get_future().wait();
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
  RemoteBench bench(kSilence, RemoteBench::Patient());
  bench.service.reset();
  auto answers = std::async(std::launch::async, [&bench] { return bench.Ask(); });
  bench.service = std::make_unique<ScriptedService>(bench.bus, kAnswer);
  CHECK(answers.get());
}

TEST_CASE("Replies to others, to older requests and second ones are ignored",
          "[planner][perception]") {
  RemoteBench bench([](int, const auto& request) {
    ReplyMessage foreign = HalfReply(request, HasNoAnswers);
    foreign.client("somebody_else");
    ReplyMessage old = HalfReply(request, HasNoAnswers);
    old.request_id(request.request_id() + 100);
    return Replies{foreign, old, HalfReply(request), HalfReply(request, HasNoAnswers)};
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
      [&timeouts_ms](int asked, const auto& request) {
        CHECK(request.person() == "anna");
        timeouts_ms.push_back(request.timeout_ms());
        return asked == 2 ? Replies{HalfReply(request)} : Replies{};
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
  RemoteBench bench([&](int asked, const auto& request) {
    addressed.push_back(request.replica());
    if (asked != 2) return Replies{HalfReply(request)};
    return refuses ? Replies{HalfReply(request, Refuses)} : Replies{};
  });
  REQUIRE(bench.Ask());
  CHECK(bench.Ask().has_value() != refuses);
  if (refuses) REQUIRE(bench.Ask());
  CHECK(addressed == std::vector<std::string>{"", "nhpm", ""});
}

// The faults report's S18: "whoever answers first decides what pictures are worth".
TEST_CASE("A request to a replica is answered by its program, whatever another one says that it is",
          "[planner][perception]") {
  const auto is_certain = [](ReplyMessage& reply) {
    std::ranges::fill(reply.answers()[0].add(), 0.9F);
  };
  const auto has_a_name_of_its_own = [&](ReplyMessage& reply) {
    is_certain(reply);
    reply.replica("nhpm-2");
  };
  const auto says_another_model = [&](ReplyMessage& reply) {
    is_certain(reply);
    reply.model_checksum(std::string(64, '7'));
  };
  for (const Spoil& forge : {Spoil(is_certain), Spoil(has_a_name_of_its_own),
                             Spoil(says_another_model), Spoil(Refuses), Spoil(IsBusy)}) {
    auto bus = std::make_shared<bus::InMemoryBus>();
    bus::Participant intruder("nhpm", bus);
    bus::Publisher<ReplyMessage> its_replies(intruder, bus::kPerceptionReply);
    const auto answer = [&](int asked, const auto& request) {
      if (asked > 1) {
        REQUIRE(its_replies.Publish(HalfReply(request, forge)));
      }
      return Replies{HalfReply(request)};
    };
    auto service = std::make_unique<ScriptedService>(bus, answer);
    bus::Participant participant("planner", bus);
    RemotePerceptionModel model(participant, RemoteBench::Patient());
    REQUIRE(model.Predict(MakeQueries(1)));
    for (int i = 0; i < 2; ++i) {
      CHECK(model.Predict(MakeQueries(1)).value().at(0).add[{2, 2}] == 0.5F);
    }
    CHECK(service->asked == 3);
    CHECK(model.unasked() == 2);
    CHECK(model.busy() == 0);
    CHECK(model.identity().checksum == std::string(64, '5'));
    // The service's next process is another writer of the same name.
    service.reset();
    service = std::make_unique<ScriptedService>(
        bus, [](int, const auto& request) { return Replies{HalfReply(request)}; });
    CHECK(model.Predict(MakeQueries(1)).value().at(0).add[{2, 2}] == 0.5F);
  }
}

TEST_CASE("Two models of one participant have names of their own", "[planner][perception]") {
  std::vector<std::string> clients;
  RemoteBench bench([&clients](int, const auto& request) {
    clients.push_back(request.client());
    return Replies{HalfReply(request)};
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

TEST_CASE("A reply without the answers of the wanted model is a service that is unavailable",
          "[planner][perception]") {
  const std::string fives(64, '5'), sixes(64, '6');
  struct Row {
    Spoil spoil;
    std::string named, model, checksum;  // the wanted ones
    bool unreadable = false;
  };
  for (const Row& row : std::vector<Row>{
           {Refuses, "9 are open"},
           {IsBusy, "9 are open"},
           {Refuses, "9 are open", "network"},
           {[](auto&) {}, fives, "", sixes},
           {[](auto&) {}, sixes, "", sixes},
           {LacksACell, "98", "", "", true},
           {[](auto& reply) { reply.answers().pop_back(); }, "answers has size 1", "", "", true}}) {
    CAPTURE(row.named, row.model, row.checksum);
    const LogLines lines;
    RemotePerceptionModel::Options options = RemoteBench::Quick();
    options.model = row.model;
    options.model_checksum = row.checksum;
    RemoteBench bench(
        [&](int, const auto& request) {
          CHECK(request.model() == row.model);
          CHECK(request.model_checksum() == row.checksum);
          return Replies{HalfReply(request, row.spoil)};
        },
        options);
    CHECK(bench.model->identity().name == (row.model.empty() ? "remote" : row.model));
    ExpectFailure(bench, ErrorCode::kUnavailable, row.named);
    CHECK(bench.model->refused() == (row.unreadable ? 1 : 0));
    if (!row.unreadable) continue;
    CHECK_THAT(lines.all.at(0),
               Catch::Contains("/conav/perception/reply") && Catch::Contains(row.named));
  }
}

TEST_CASE("The model that answers gives its name, and is logged once and when it changes",
          "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](int asked, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    if (asked > 2) reply.model_checksum(std::string(64, '7'));
    return Replies{reply};
  });
  for (int i = 0; i < 4; ++i) CHECK(bench.Ask().value().at(1).add[{2, 2}] == 0.5F);
  CHECK(bench.model->identity().name == "half");
  CHECK(bench.service->asked == 4);
  REQUIRE(lines.all.size() == 2);
  CHECK_THAT(lines.all[0], Catch::Contains("half") && Catch::Contains(std::string(64, '5')));
  CHECK_THAT(lines.all[1], Catch::Contains(std::string(64, '7')));
}

TEST_CASE("A busy service is asked again after a pause, and not reported as one that is silent",
          "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](int asked, const auto& request) {
    const bool is_busy = asked == 2 || asked == 3;
    return Replies{is_busy ? HalfReply(request, IsBusy) : HalfReply(request)};
  });
  REQUIRE(bench.Ask());
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 4);
  CHECK(bench.model->busy() == 2);
  CHECK(bench.model->repeats() == 0);
  REQUIRE(lines.all.size() >= 2);  // the first says which model answers
  CHECK_THAT(lines.all[1], Catch::Contains("busy") && Catch::Contains("replica=nhpm"));
}

TEST_CASE("The good reply of a replica counts, whatever the others say", "[planner][perception]") {
  const auto is_unreadable = [](ReplyMessage& reply) {
    LacksACell(reply);
    reply.model_checksum(std::string(64, '7'));
  };
  const auto is_of_another_model = [](ReplyMessage& reply) { reply.model("whole"); };
  for (const Spoil& spoil :
       {Spoil(Refuses), Spoil(is_unreadable), Spoil(IsBusy), Spoil(is_of_another_model)}) {
    std::vector<std::string> addressed;
    auto options = RemoteBench::Quick();
    options.model = "half";
    RemoteBench bench(
        [&](int, const auto& request) {
          addressed.push_back(request.replica());
          ReplyMessage bad = HalfReply(request, spoil);
          bad.replica("bad");
          if (request.replica() == "nhpm") return Replies{HalfReply(request)};
          if (request.replica() == "bad") return Replies{bad};
          return Replies{bad, HalfReply(request)};
        },
        options);
    bus::Participant second("bad", bench.bus);  // so that two are counted
    const bus::Publisher<ReplyMessage> its_replies(second, bus::kPerceptionReply);
    REQUIRE(bench.Ask());
    CHECK(bench.model->identity() == ModelIdentity{"half", "1", std::string(64, '5')});
    REQUIRE(bench.Ask());
    CHECK(addressed == std::vector<std::string>{"", "nhpm"});
  }
}

}  // namespace
}  // namespace conav::planner
