#include <catch2/catch.hpp>

#include "common/runtime/log.h"
#include "planner/perception/remote_model.h"
#include "unit/planner/perception/scripted_service.h"

namespace conav::planner {
namespace {

using namespace tests;

TEST_CASE("A refusal is a failure of that service, given with its reason",
          "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    reply.status(conav_msgs::msg::PERCEPTION_STATUS_REFUSED);
    reply.reason("too large");
    reply.answers().clear();
    service.Reply(reply);
  });
  ExpectFailure(bench, ErrorCode::kUnavailable, "perception service refused: too large");
}

TEST_CASE("A reply that does not fit the request is refused, counted and logged",
          "[planner][perception]") {
  std::vector<std::string> lines;
  log::SetSink([&lines](const log::Record& record) { lines.emplace_back(record.text); });
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
  log::SetSink(nullptr);
  CHECK(bench.model->refused() == 2);
  CHECK_THAT(lines, Catch::VectorContains<std::string>(
                        "message refused topic=/conav/perception/reply reason=answers has size 1, "
                        "not that of the queries, 2 count=1"));
}

TEST_CASE("Which model answers is logged once, and when that changes", "[planner][perception]") {
  std::vector<std::string> lines;
  log::SetSink([&lines](const log::Record& record) { lines.emplace_back(record.text); });
  RemoteBench bench([](auto& service, const auto& request) {
    ReplyMessage reply = HalfReply(request);
    if (request.request_id() > 2) reply.model_checksum(std::string(64, '7'));
    service.Reply(reply);
  });
  for (int i = 0; i < 4; ++i) REQUIRE(bench.Ask());
  log::SetSink(nullptr);
  REQUIRE(lines.size() == 2);
  CHECK_THAT(lines[0], Catch::StartsWith("perception model answers model=half") &&
                           Catch::Contains("checksum=" + std::string(64, '5')));
  CHECK_THAT(lines[1], Catch::Contains("checksum=" + std::string(64, '7')));
}

TEST_CASE("Only replicas with another model: unavailable, with their reason",
          "[planner][perception]") {
  auto options = RemoteBench::Quick();
  options.model = "network";
  RemoteBench bench(
      [](auto& service, const auto& request) {
        CHECK(request.model() == "network");
        ReplyMessage reply = HalfReply(request);
        reply.status(conav_msgs::msg::PERCEPTION_STATUS_REFUSED);
        reply.reason("'network' is not served here");
        service.Reply(reply);
      },
      options);
  CHECK(bench.model->identity().name == "network");
  ExpectFailure(bench, ErrorCode::kUnavailable, "'network' is not served here");
}

TEST_CASE("A busy service is asked again after a pause", "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(service.asked < 3 ? BusyReply(request) : HalfReply(request));
  });
  REQUIRE(bench.Ask());
  CHECK(bench.service->asked == 3);
  CHECK(bench.model->busy() == 2);
}

TEST_CASE("A service that stays busy is unavailable, with its reason", "[planner][perception]") {
  RemoteBench bench([](auto& service, const auto& request) { service.Reply(BusyReply(request)); });
  ExpectFailure(bench, ErrorCode::kUnavailable, "perception service is busy: 9 requests are open");
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
  std::vector<std::string> lines;
  log::SetSink([&lines](const log::Record& record) { lines.emplace_back(record.text); });
  RemoteBench bench([](auto& service, const auto& request) {
    service.Reply(service.asked == 2 ? BusyReply(request) : HalfReply(request));
  });
  REQUIRE(bench.Ask());
  REQUIRE(bench.Ask());
  log::SetSink(nullptr);
  CHECK(bench.service->asked == 3);
  CHECK(bench.model->repeats() == 0);
  REQUIRE(lines.size() == 2);  // the first says which model answers
  CHECK(lines[1] == "perception service busy replica=nhpm reason=9 requests are open count=1");
}

TEST_CASE("An answer of other weights than those wanted is refused", "[planner][perception]") {
  auto options = RemoteBench::Quick();
  options.model_checksum = std::string(64, '6');
  RemoteBench bench(
      [](auto& service, const auto& request) {
        CHECK(request.model_checksum() == std::string(64, '6'));
        service.Reply(HalfReply(request));
      },
      options);
  ExpectFailure(
      bench, ErrorCode::kUnavailable,
      "model 'half' " + std::string(64, '5') + " answered, wanted '' " + std::string(64, '6'));
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
