#include "common/bus/changes.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <string>

#include "common/bus/in_memory_bus.h"
#include "common/msg/convert.h"
#include "unit/common/msg/samples.h"

namespace conav::bus {
namespace {

using conav_msgs::msg::MessageChange;
using Bytes = std::vector<std::uint8_t>;

/// What a decoder that had all before makes of it.
Bytes Decoded(ChangeDecoder& decoder, const MessageChange& change) {
  const auto bytes = decoder.Decode(change);
  REQUIRE(bytes);
  REQUIRE(bytes->has_value());
  return {(*bytes)->begin(), (*bytes)->end()};
}

Bytes Counting(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

TEST_CASE("a change has the bytes that differ, and few others", "[bus]") {
  ChangeEncoder encoder;
  ChangeDecoder decoder;
  Bytes message = Counting(1000);
  CHECK(Decoded(decoder, encoder.Encode(message)) == message);

  message[10] = message[12] = message[500] = 7;
  const MessageChange change = encoder.Encode(message);
  CHECK_FALSE(change.whole());
  CHECK(change.offsets() == std::vector<std::uint32_t>{10, 500});
  CHECK(change.lengths() == std::vector<std::uint32_t>{3, 1});
  CHECK(change.bytes() == Bytes{7, 11, 7, 7});
  CHECK(Decoded(decoder, change) == message);

  CHECK(encoder.Encode(message).bytes().empty());
}

TEST_CASE("a message may grow and shrink", "[bus]") {
  ChangeEncoder encoder;
  ChangeDecoder decoder;
  for (const std::size_t size : {100u, 140u, 3u, 0u, 50u}) {
    const Bytes message = Counting(size);
    CHECK(Decoded(decoder, encoder.Encode(message)) == message);
  }
}

TEST_CASE("a late joiner has the newest after the history that a topic keeps", "[bus]") {
  ChangeEncoder encoder;
  std::vector<MessageChange> all;
  Bytes message = Counting(100);
  for (std::uint8_t i = 0; i < 100; ++i) {
    message[i] = 0;
    all.push_back(encoder.Encode(message));
    if (all.size() > std::size_t{kChangesQos.depth}) all.erase(all.begin());
    ChangeDecoder late;
    std::optional<std::span<const std::uint8_t>> newest;
    for (const MessageChange& one : all) {
      const auto decoded = late.Decode(one);
      REQUIRE(decoded);
      if (*decoded) newest = *decoded;
    }
    REQUIRE(newest);
    CHECK(Bytes(newest->begin(), newest->end()) == message);
  }
}

TEST_CASE("a change of another base says nothing, and broken ones are refused", "[bus]") {
  ChangeEncoder encoder;
  ChangeDecoder decoder;
  Bytes message = Counting(20);
  const MessageChange whole = encoder.Encode(message);
  message[3] = 99;
  const MessageChange change = encoder.Encode(message);
  REQUIRE(decoder.Decode(change));
  CHECK_FALSE(*decoder.Decode(change));
  Decoded(decoder, whole);

  using Break = void (*)(MessageChange&);
  const Break broken[] = {
      [](MessageChange& c) { c.offsets() = {20}; },
      [](MessageChange& c) { c.offsets() = {0xffffffff}, c.lengths() = {0xffffffff}; },
      [](MessageChange& c) { c.lengths() = {2}; },
      [](MessageChange& c) {
        c.lengths() = {1, 1};
      },
      [](MessageChange& c) { c.size(0xffffffff); },
      [](MessageChange& c) { c.whole(true); },
  };
  for (const Break wreck : broken) {
    MessageChange wrong = change;
    wreck(wrong);
    CHECK_FALSE(decoder.Decode(wrong));
  }
  CHECK(Decoded(decoder, change) == message);
}

/// A robot, and a program that reads its maps; the robot is found.
struct MapBench {
  explicit MapBench(bool over_link) {
    if (over_link) bus->SetOverLink();
    reader.emplace("reader", bus);
    maps.emplace(*reader, kRobotMap, kRobotMapChanges, "r1");
    robot.emplace("robot", bus);
    publisher.emplace(*robot, kRobotMap, kRobotMapChanges, "r1");
    maps->TakeValid(kToDomain);
  }
  std::vector<MapUpdate> Give() {
    publisher->Send(ToMessage(map));
    return maps->TakeValid(kToDomain);
  }

  std::shared_ptr<InMemoryBus> bus = std::make_shared<InMemoryBus>();
  std::optional<Participant> reader;
  std::optional<ChangesSubscriber<nav_msgs::msg::OccupancyGrid>> maps;
  std::optional<Participant> robot;
  std::optional<ChangesPublisher<nav_msgs::msg::OccupancyGrid>> publisher;
  MapUpdate map = samples::SampleMap();
};

TEST_CASE("maps arrive over a link as changes, and else whole", "[bus]") {
  const bool over_link = GENERATE(true, false);
  MapBench bench(over_link);
  Subscriber<MessageChange> changes(*bench.reader, kRobotMapChanges, "r1");
  for (int i = 0; i < 3; ++i) {
    bench.map.stamp = bench.map.stamp + std::chrono::milliseconds(1);
    const auto given = bench.Give();
    REQUIRE(given.size() == 1);
    CHECK(given[0].stamp == bench.map.stamp);
    CHECK(given[0].cells == bench.map.cells);
  }
  const auto sent = changes.Take();
  REQUIRE(sent.size() == (over_link ? 3 : 0));
  if (!over_link) return;
  CHECK(sent[0].whole());
  CHECK(sent[2].bytes().size() < 16);  // of the stamp
}

TEST_CASE("a map without changes is read whole, over a link too", "[bus]") {
  MapBench bench(true);
  bench.publisher.reset();
  bench.maps->TakeValid(kToDomain);
  CHECK(bench.maps->matched_publishers() == 0);
  Publisher<nav_msgs::msg::OccupancyGrid> whole(*bench.robot, kRobotMap, "r1");
  CHECK(bench.maps->matched_publishers() == 1);
  REQUIRE(whole.Publish(ToMessage(bench.map)));
  CHECK(bench.maps->TakeValid(kToDomain).size() == 1);
  // A change that is older is no news.
  Publisher<MessageChange> late(*bench.robot, kRobotMapChanges, "r1");
  bench.maps->TakeValid(kToDomain);
  std::vector<std::uint8_t> payload(10'000);
  const auto message = ToMessage(bench.map);
  payload.resize(ToPayload(TypeSupportOf<nav_msgs::msg::OccupancyGrid>(), &message, payload));
  bench.bus->SetSourceDelay(std::chrono::seconds(10));
  REQUIRE(late.Publish(ChangeEncoder().Encode(payload)));
  CHECK(bench.maps->TakeValid(kToDomain).empty());
  bench.bus->SetSourceDelay({});
  REQUIRE(late.Publish(ChangeEncoder().Encode(payload)));
  CHECK(bench.maps->TakeValid(kToDomain).size() == 1);
  // Bytes that are no map are refused.
  payload.resize(20);
  REQUIRE(late.Publish(ChangeEncoder().Encode(payload)));
  CHECK(bench.maps->TakeValid(kToDomain).empty());
}

}  // namespace
}  // namespace conav::bus
