#include <catch2/catch.hpp>

#include "common/runtime/log.h"
#include "planner/perception/remote_model.h"
#include "unit/planner/perception/scripted_service.h"

namespace conav::planner {
namespace {

using namespace tests;

struct LogLines {
  LogLines() {
    log::SetSink([this](const log::Record& record) { all.emplace_back(record.text); });
  }
  ~LogLines() { log::SetSink(nullptr); }
  std::vector<std::string> all;
};

TEST_CASE("A service that cannot answer is unavailable, with its reason", "[planner][perception]") {
  const auto& [status, reason, told] = GENERATE(table<std::uint8_t, std::string, std::string>(
      {{conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "too large",
        "perception service refused: too large"},
       {conav_msgs::msg::PERCEPTION_STATUS_BUSY, "9 requests are open",
        "perception service is busy: 9 requests are open"}}));
  RemoteBench bench([&](auto& service, const auto& request) {
    service.Reply(WithoutAnswers(request, status, reason));
  });
  ExpectFailure(bench, ErrorCode::kUnavailable, told);
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
  ExpectFailure(bench, ErrorCode::kUnavailable,
                "perception reply: answers has size 1, not that of the queries, 2");
  ExpectFailure(bench, ErrorCode::kUnavailable,
                "perception reply: answers[0].add has size 98, not 9 x 11");
  CHECK(bench.model->refused() == 2);
  CHECK_THAT(lines.all,
             Catch::VectorContains<std::string>(
                 "message refused topic=/conav/perception/reply reason=answers has size 1, "
                 "not that of the queries, 2 count=1"));
}

TEST_CASE("Which model answers is logged once, and when that changes", "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    if (request.request_id() > 2) reply.model_checksum(std::string(64, '7'));
    service.Reply(reply);
  });
  for (int i = 0; i < 4; ++i) REQUIRE(bench.Ask());
  REQUIRE(lines.all.size() == 2);
  CHECK_THAT(lines.all[0], Catch::StartsWith("perception model answers model=half") &&
                               Catch::Contains("checksum=" + std::string(64, '5')));
  CHECK_THAT(lines.all[1], Catch::Contains("checksum=" + std::string(64, '7')));
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
          service.Reply(WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED,
                                       "'network' is not served here"));
        },
        options);
    CHECK(bench.model->identity().name == "network");
    ExpectFailure(bench, ErrorCode::kUnavailable, "'network' is not served here");
  }
  SECTION("other weights") {
    options.model_checksum = other;
    RemoteBench bench(
        [&](auto& service, const auto& request) {
          CHECK(request.model_checksum() == other);
          service.Reply(HalfReply(request));
        },
        options);
    ExpectFailure(bench, ErrorCode::kUnavailable,
                  "model 'half' " + std::string(64, '5') + " answered, wanted '' " + other);
  }
}

TEST_CASE("A busy service is asked again after a pause", "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(service.asked < 3 ? BusyReply(request) : HalfReply(request));
  });
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 3);
  CHECK(bench.model->busy() == 2);
}

TEST_CASE("The good reply of another replica counts while one is busy", "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(BusyReply(request));
    service.Reply(HalfReply(request));
  });
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 1);
}

/// Two replicas, "nhpm" that answers and "bad", which gets the word first; whom each request was
/// addressed to.
struct TwoReplicas {
  explicit TwoReplicas(std::function<ReplyMessage(const RequestMessage&)> bad)
      : bench([this, bad](auto& service, const auto& request) {
          addressed.push_back(request.replica());
          ReplyMessage reply = bad(request);
          reply.replica("bad");
          if (request.replica().empty() || request.replica() == "bad") service.Reply(reply);
          if (request.replica().empty() || request.replica() == "nhpm") {
            service.Reply(HalfReply(request));
          }
        }) {}
  std::vector<std::string> addressed;
  RemoteBench bench;
  bus::Participant second{"bad", bench.bus};  // so that two are counted
  bus::Publisher<ReplyMessage> its_replies{second, bus::kPerceptionReply};
};

TEST_CASE(
    "A replica that refuses, or cannot be understood, does not keep a good one from answering",
    "[planner][perception]") {
  const auto refusing = [](const RequestMessage& request) {
    return WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "too large");
  };
  const auto unreadable = [](const RequestMessage& request) {
    ReplyMessage reply = HalfReply(request);
    reply.model("other");
    reply.answers()[0].add().pop_back();
    return reply;
  };
  using Bad = std::function<ReplyMessage(const RequestMessage&)>;
  for (const Bad& bad : {Bad(refusing), Bad(unreadable)}) {
    TwoReplicas both(bad);
    REQUIRE(both.bench.Ask());
    CHECK(both.bench.model->identity().name == "half");
    REQUIRE(both.bench.Ask());
    CHECK(both.addressed == std::vector<std::string>{"", "nhpm"});
  }
}

TEST_CASE("A replica that refuses after it answered is no longer the one that is asked",
          "[planner][perception]") {
  std::vector<std::string> addressed;
  RemoteBench bench([&addressed](auto& service, const auto& request) {
    addressed.push_back(request.replica());
    service.Reply(service.asked == 2
                      ? WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_REFUSED, "no")
                      : HalfReply(request));
  });
  REQUIRE(bench.Ask());
  ExpectFailure(bench, ErrorCode::kUnavailable, "perception service refused: no");
  REQUIRE(bench.Ask());
  CHECK(addressed == std::vector<std::string>{"", "nhpm", ""});
}

TEST_CASE("A busy replica is not reported as one that did not answer", "[planner][perception]") {
  const LogLines lines;
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(service.asked == 2 ? BusyReply(request) : HalfReply(request));
  });
  REQUIRE(bench.Ask());
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 3);
  CHECK(bench.model->repeats() == 0);
  REQUIRE(lines.all.size() == 2);  // the first says which model answers
  CHECK(lines.all[1] == "perception service busy replica=nhpm reason=9 requests are open count=1");
}

TEST_CASE("The reply of a replica with the wanted model counts, whatever the others say",
          "[planner][perception]") {
  auto options = RemoteBench::Quick();
  options.model = "half";
  RemoteBench bench(
      [](auto& service, const auto& request) {
        ReplyMessage other = HalfReply(request);
        other.model("whole");
        other.replica("nhpm-2");
        service.Reply(other);
        service.Reply(HalfReply(request));
      },
      options);
  const auto answers = bench.Ask();
  REQUIRE(answers);
  CHECK(bench.model->identity().name == "half");
  CHECK(bench.model->identity().checksum == std::string(64, '5'));
}

}  // namespace
}  // namespace conav::planner
