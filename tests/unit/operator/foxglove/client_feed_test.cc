#include "operator/foxglove/client_feed.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace conav::foxglove {
namespace {

using namespace std::chrono_literals;
using console::ROLE_OBSERVER;
using console::ROLE_OPERATOR;
using nlohmann::json;

constexpr std::uint32_t kStates = 1;
constexpr std::uint32_t kPictures = 2;

Catalog TwoChannels() {
  Catalog catalog;
  catalog.channels = {
      {{kStates, "/r1/state", "conav_msgs/msg/RobotState", "x"}, Backlog::kQueue, 1},
      {{kPictures, "/r1/camera", "sensor_msgs/msg/CompressedImage", "x"}, Backlog::kNewest, 0}};
  catalog.services = {{1, "/r1/stop"}};
  catalog.goal_topics = {"/r1/goal_pose"};
  catalog.parameters = {{"/operator.a", "1"}};
  catalog.session = "run";
  return catalog;
}

ChannelMessage Message(std::uint32_t channel, const std::string& text) {
  return {channel, 5, std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end())};
}

/// One client's feed, and what it tells its server.
struct FeedBench : FeedHost {
  explicit FeedBench(console::Role role = ROLE_OPERATOR, ClientFeed::Limits limits = {})
      : feed(std::in_place, catalog, *this, 1, role, limits, now) {
    while (feed->Next(now)) {
    }
  }

  std::vector<ChannelMessage> Join(std::uint32_t channel) override {
    joined.push_back(channel);
    return kept;
  }
  void Left(std::uint32_t channel) override { left.push_back(channel); }
  bool Ask(std::uint64_t, Asked body) override {
    if (has_room) asked.push_back(std::move(body));
    return has_room;
  }
  std::shared_ptr<const std::string> graph() override {
    return std::make_shared<const std::string>("{}");
  }
  void CountSkipped(std::uint64_t, std::uint64_t messages) override { skipped += messages; }

  void Say(const json& text) { feed->Take(text.dump(), true, now); }
  void Subscribe(std::uint32_t id, std::uint32_t channel) {
    Say({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}});
  }
  void AdvertiseGoals(const char* topic = "/r1/goal_pose", const char* encoding = "json",
                      const char* schema = "geometry_msgs/PoseStamped") {
    Say({{"op", "advertise"},
         {"channels",
          {{{"id", 1}, {"topic", topic}, {"encoding", encoding}, {"schemaName", schema}}}}});
  }
  /// The payloads of all messages that are due, or the texts, in order.
  std::vector<std::string> Drain() {
    std::vector<std::string> all;
    while (auto message = feed->Next(now)) {
      all.push_back(message->payload
                        ? std::string(message->payload->begin(), message->payload->end())
                        : message->bytes);
    }
    return all;
  }
  /// The only text that is due: a status with these words.
  void Complains(const std::string& words) {
    const auto texts = Drain();
    REQUIRE(texts.size() == 1);
    const json status = json::parse(texts[0]);
    CHECK(status["op"] == "status");
    CHECK_THAT(status["message"].get<std::string>(), Catch::Contains(words));
  }

  Catalog catalog = TwoChannels();
  Clock::TimePoint now{100s};
  std::vector<ChannelMessage> kept;
  std::vector<std::uint32_t> joined;
  std::vector<std::uint32_t> left;
  std::vector<Asked> asked;
  std::uint64_t skipped = 0;
  bool has_room = true;
  std::optional<ClientFeed> feed;
};

}  // namespace

TEST_CASE("a client is greeted with what there is", "[operator][foxglove]") {
  FeedBench bench;
  ClientFeed feed(bench.catalog, bench, 2, ROLE_OBSERVER, {}, bench.now);
  CHECK(json::parse(feed.Next(bench.now)->bytes)["sessionId"] == "run");
  CHECK(json::parse(feed.Next(bench.now)->bytes)["channels"].size() == 2);
  CHECK(json::parse(feed.Next(bench.now)->bytes)["services"][0]["name"] == "/r1/stop");
  CHECK_FALSE(feed.Next(bench.now));
}

TEST_CASE("a client gets what it subscribes to, until it no longer does", "[operator][foxglove]") {
  FeedBench bench;
  bench.feed->Add(Message(kStates, "before"));
  bench.kept = {Message(kStates, "kept")};
  bench.Subscribe(7, kStates);
  CHECK(bench.joined == std::vector<std::uint32_t>{kStates});
  bench.feed->Add(Message(kStates, "new"));
  const auto first = bench.feed->Next(bench.now);
  CHECK(first->bytes == MessageHead(7, 5));
  CHECK_FALSE(first->is_text);
  CHECK(bench.Drain() == std::vector<std::string>{"new"});
  bench.feed->Add(Message(kStates, "on its way"));
  bench.Say({{"op", "unsubscribe"}, {"subscriptionIds", {7}}});
  CHECK(bench.left == std::vector<std::uint32_t>{kStates});
  CHECK(bench.Drain().empty());
  CHECK(bench.feed->queued_bytes() == 0);
  bench.Subscribe(7, kPictures);
  bench.feed.reset();
  CHECK(bench.left == std::vector<std::uint32_t>{kStates, kPictures});
}

TEST_CASE("of pictures that wait only the newest is sent, without a complaint",
          "[operator][foxglove]") {
  FeedBench bench;
  bench.kept.clear();
  bench.Subscribe(1, kPictures);
  for (const char* picture : {"1", "2", "3"}) bench.feed->Add(Message(kPictures, picture));
  CHECK(bench.Drain() == std::vector<std::string>{"3"});
  CHECK(bench.skipped == 0);
}

TEST_CASE("a slow client misses the oldest, and a status says so once a second",
          "[operator][foxglove]") {
  FeedBench bench;
  bench.Subscribe(1, kStates);
  for (std::size_t i = 0; i < ClientFeed::kQueueMessages + 2; ++i) {
    bench.feed->Add(Message(kStates, std::to_string(i)));
  }
  const auto all = bench.Drain();
  REQUIRE(all.size() == ClientFeed::kQueueMessages + 1);
  CHECK_THAT(all[0], Catch::Contains("2 messages were skipped"));
  CHECK(all[1] == "2");
  CHECK(bench.skipped == 2);

  for (std::size_t i = 0; i < ClientFeed::kQueueMessages + 1; ++i) {
    bench.feed->Add(Message(kStates, "again"));
  }
  CHECK(bench.Drain().size() == ClientFeed::kQueueMessages);
  bench.now += 1s;
  CHECK(bench.Drain().size() == 1);
  CHECK(bench.skipped == 3);
}

TEST_CASE("a client's queue holds so many bytes, and at least one message",
          "[operator][foxglove]") {
  FeedBench bench(ROLE_OPERATOR, {.queue_bytes = 10});
  bench.Subscribe(1, kStates);
  bench.Subscribe(2, kPictures);
  bench.feed->Add(Message(kPictures, "1234567"));
  bench.feed->Add(Message(kStates, "890"));
  CHECK(bench.feed->queued_bytes() == 10);
  bench.feed->Add(Message(kStates, "a"));
  CHECK(bench.feed->queued_bytes() == 4);
  bench.feed->Add(Message(kStates, "more than ten bytes"));
  const auto all = bench.Drain();
  REQUIRE(all.size() == 2);
  CHECK(all[1] == "more than ten bytes");
  CHECK(bench.skipped == 3);
}

TEST_CASE("a client that takes nothing costs so many answers, or bytes of them",
          "[operator][foxglove]") {
  const std::size_t bytes = GENERATE(std::size_t{1} << 20, std::size_t{1000});
  FeedBench bench(ROLE_OPERATOR,
                  {.queue_bytes = bytes, .message_rate = 1e4, .message_burst = 10000});
  std::size_t asked = 0;
  while (bench.feed->fault().empty() && asked <= ClientFeed::kReplies) {
    bench.Say({{"op", "getParameters"}, {"parameterNames", json::array()}});
    ++asked;
  }
  CHECK((asked == ClientFeed::kReplies + 1) == (bytes > 1000));
  CHECK(bench.Drain().size() == 1);
  CHECK(bench.feed->finished());
  CHECK(bench.feed->retry());
}

TEST_CASE("the time is sent when it has changed, and not too often", "[operator][foxglove]") {
  FeedBench bench(ROLE_OPERATOR, {.time_rate_hz = 10.0});
  bench.feed->SetTime(7);
  CHECK(bench.Drain() == std::vector<std::string>{TimeBytes(7)});
  bench.feed->SetTime(8);
  CHECK(bench.Drain().empty());
  CHECK(bench.feed->due() == bench.now + 100ms);
  bench.now += 100ms;
  CHECK(bench.Drain() == std::vector<std::string>{TimeBytes(8)});
  bench.now += 1s;
  CHECK(bench.Drain().empty());
}

TEST_CASE("what a client may not have is answered with a status", "[operator][foxglove]") {
  FeedBench bench;
  bench.Subscribe(1, kStates);
  SECTION("a channel that is not there") {
    bench.Subscribe(2, GENERATE(0U, 3U, 4294967295U));
    bench.Complains("no channel");
  }
  SECTION("a channel twice") {
    bench.Subscribe(2, kStates);
    bench.Complains("subscribed already");
  }
  SECTION("a subscription twice") {
    bench.Subscribe(1, kPictures);
    bench.Complains("in use");
  }
  SECTION("a subscription that is not there") {
    bench.Say({{"op", "unsubscribe"}, {"subscriptionIds", {2}}});
    bench.Complains("no subscription 2");
  }
  SECTION("an operation that is not offered") {
    bench.Say({{"op", "playbackControl"}});
    bench.Complains("playbackControl");
  }
  SECTION("a command's topic") {
    bench.AdvertiseGoals("/r1/command");
    bench.Complains("goals only");
  }
  SECTION("a goal of another type") {
    bench.AdvertiseGoals("/r1/goal_pose", "json", "geometry_msgs/Pose");
    bench.Complains("PoseStamped");
  }
  SECTION("a goal in another encoding") {
    bench.AdvertiseGoals("/r1/goal_pose", "protobuf");
    bench.Complains("encoding");
  }
  SECTION("a message without a channel") {
    bench.feed->Take(std::string_view("\1\1\0\0\0x", 6), false, bench.now);
    bench.Complains("not advertised");
  }
  CHECK(bench.joined.size() == 1);
  CHECK(bench.asked.empty());
  CHECK_FALSE(bench.feed->finished());
}

TEST_CASE("an observer may call services, but not publish", "[operator][foxglove]") {
  FeedBench bench(ROLE_OBSERVER);
  bench.AdvertiseGoals();
  bench.Complains("observer");
  bench.feed->Take(std::string_view("\2\1\0\0\0\7\0\0\0\3\0\0\0cdr", 16), false, bench.now);
  REQUIRE(bench.asked.size() == 1);
  CHECK(std::get<CallService>(bench.asked[0]).call == 7);
}

TEST_CASE("a goal goes to the service with its channel's topic and encoding",
          "[operator][foxglove]") {
  FeedBench bench;
  bench.AdvertiseGoals();
  const std::string_view goal("\1\1\0\0\0{}", 7);
  bench.feed->Take(goal, false, bench.now);
  REQUIRE(bench.asked.size() == 1);
  const auto& asked = std::get<PublishGoal>(bench.asked[0]);
  CHECK(asked.topic == "/r1/goal_pose");
  CHECK(asked.encoding == "json");
  CHECK(asked.payload == "{}");
  bench.has_room = false;
  bench.feed->Take(goal, false, bench.now);
  bench.Complains("does not keep up");
  bench.has_room = true;
  bench.Say({{"op", "unadvertise"}, {"channelIds", {1}}});
  bench.feed->Take(goal, false, bench.now);
  bench.Complains("not advertised");
}

TEST_CASE("a service call that cannot be made fails by its number", "[operator][foxglove]") {
  FeedBench bench;
  const auto [call, why] = GENERATE(table<std::string, std::string>({
      {std::string("\2\2\0\0\0\7\0\0\0\3\0\0\0cdr", 16), "no service 2"},
      {std::string("\2\1\0\0\0\7\0\0\0\4\0\0\0ros1", 17), "encoding"},
  }));
  bench.feed->Take(call, false, bench.now);
  const auto failure = json::parse(bench.Drain().at(0));
  CHECK(failure["op"] == "serviceCallFailure");
  CHECK(failure["callId"] == 7);
  CHECK_THAT(failure["message"].get<std::string>(), Catch::Contains(why));
  CHECK(bench.asked.empty());
}

TEST_CASE("parameters are shown, and none is set", "[operator][foxglove]") {
  FeedBench bench;
  bench.Say({{"op", "setParameters"},
             {"parameters", {{{"name", "/operator.a"}, {"value", 2}}}},
             {"id", "set"}});
  const auto texts = bench.Drain();
  REQUIRE(texts.size() == 2);
  CHECK_THAT(json::parse(texts[0])["message"].get<std::string>(), Catch::Contains("cannot be set"));
  CHECK(json::parse(texts[1])["id"] == "set");
  CHECK(json::parse(texts[1])["parameters"][0]["value"] == 1);
}

TEST_CASE("a client that sends garbage, or too much, is closed with the reason",
          "[operator][foxglove]") {
  FeedBench bench(ROLE_OPERATOR, {.message_rate = 1.0, .message_burst = ClientFeed::kFaults});
  SECTION("garbage") {
    for (int i = 0; i < ClientFeed::kFaults; ++i) {
      CHECK_FALSE(bench.feed->finished());
      bench.feed->Take("\xff", i % 2 == 0, bench.now);
    }
    CHECK_FALSE(bench.feed->retry());
  }
  SECTION("too much") {
    for (int i = 0; i <= ClientFeed::kFaults; ++i) bench.Say({{"op", "subscribeConnectionGraph"}});
    CHECK(bench.feed->retry());
  }
  CHECK_FALSE(bench.Drain().empty());
  CHECK(bench.feed->finished());
  CHECK_FALSE(bench.feed->fault().empty());
  bench.feed->Take("{}", true, bench.now);
  CHECK(bench.Drain().empty());
}

}  // namespace conav::foxglove
