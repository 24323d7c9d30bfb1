#include "common/bus/in_memory_bus.h"

#include <catch2/catch.hpp>
#include <thread>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "support/test_messages.h"

namespace conav::bus {
namespace {

using conav_test::msg::Blob;
using std::chrono::milliseconds;

constexpr Topic<Blob> kVolatile{"/{}/volatile", kDefaultQos};
constexpr Topic<Blob> kLatched{"/{}/latched", kLatchedQos};
constexpr Topic<Blob> kThree{"/{}/three", {Reliability::kReliable, Durability::kTransientLocal, 3}};

struct Pair {
  std::shared_ptr<InMemoryBus> bus = std::make_shared<InMemoryBus>();
  Participant left{"left", bus};
  Participant right{"right", bus};
};

std::vector<std::uint64_t> Ids(const std::vector<Blob>& blobs) {
  std::vector<std::uint64_t> ids;
  for (const Blob& blob : blobs) ids.push_back(blob.id());
  return ids;
}

template <class Sender>
void PublishIds(Sender& publisher, std::initializer_list<std::uint64_t> ids) {
  for (const auto id : ids) REQUIRE(publisher.Publish(test::MakeBlob(id, 10)));
}

TEST_CASE("a message is there when Publish returns, whole and in order", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Subscriber<Blob> subscriber(pair.right, kVolatile, "r1");
  const Blob first = test::MakeBlob(1, 100);
  const Blob second = test::MakeBlob(2, 0);
  REQUIRE(publisher.Publish(first));
  REQUIRE(publisher.Publish(second));
  CHECK(subscriber.Take() == std::vector<Blob>{first, second});
  CHECK(subscriber.Take().empty());
}

TEST_CASE("topics of other entities and participants alone do not mix", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Subscriber<Blob> other(pair.left, kVolatile, "r2");
  Subscriber<Blob> own(pair.left, kVolatile, "r1");
  PublishIds(publisher, {1});
  CHECK(other.Take().empty());
  CHECK(Ids(own.Take()) == std::vector<std::uint64_t>{1});
}

TEST_CASE("a message carries the time of its publication, also for late subscribers",
          "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kLatched, "r1");
  const auto now = std::chrono::system_clock::now();
  pair.bus->SetSourceDelay(std::chrono::hours(1));
  PublishIds(publisher, {1});
  pair.bus->SetSourceDelay(std::chrono::hours(0));
  Subscriber<Blob> late(pair.right, kLatched, "r1");
  const auto taken = late.TakeStamped();
  REQUIRE(taken.size() == 1);
  CHECK(taken[0].value.id() == 1);
  CHECK(taken[0].source < now);
  PublishIds(publisher, {2});
  CHECK(late.TakeStamped().at(0).source >= now);
}

TEST_CASE("a late joiner gets the last samples of a transient-local writer that is still there",
          "[in-memory]") {
  struct Row {
    Topic<Blob> topic;
    std::vector<std::uint64_t> late;    // of 1 to 5, sent before
    std::vector<std::uint64_t> queued;  // of the same, sent again
  };
  for (const Row& row : {Row{kVolatile, {}, {1, 2, 3, 4, 5}}, Row{kLatched, {5}, {5}},
                         Row{kThree, {3, 4, 5}, {3, 4, 5}}}) {
    Pair pair;
    {
      Publisher<Blob> publisher(pair.left, row.topic, "r1");
      PublishIds(publisher, {1, 2, 3, 4, 5});
      Subscriber<Blob> subscriber(pair.right, row.topic, "r1");
      CHECK(Ids(subscriber.Take()) == row.late);
      PublishIds(publisher, {1, 2, 3, 4, 5});
      CHECK(Ids(subscriber.Take()) == row.queued);  // a full queue drops the oldest
    }
    Subscriber<Blob> after(pair.right, row.topic, "r1");
    CHECK(after.Take().empty());  // history goes with its writer
  }
}

TEST_CASE("matches are counted and reported to both sides", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  CHECK(publisher.matched_subscribers() == 0);
  {
    Subscriber<Blob> subscriber(pair.right, kVolatile, "r1");
    CHECK(publisher.matched_subscribers() == 1);
    CHECK(subscriber.matched_publishers() == 1);
    const auto events = pair.right.TakeEvents();
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == Event::Kind::kMatched);
    CHECK(events[0].topic == "/r1/volatile");
  }
  CHECK(publisher.matched_subscribers() == 0);
  const auto events = pair.left.TakeEvents();
  REQUIRE(events.size() == 2);
  CHECK(events[1].kind == Event::Kind::kUnmatched);
  CHECK(pair.left.TakeEvents().empty());
}

TEST_CASE("a publisher knows how many of its subscribers ask for the full rate", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Topic<Blob> sparse = Sparse(kVolatile);
  {
    const Subscriber<Blob> recorder(pair.right, sparse, "r1");
    CHECK(publisher.matched_subscribers() == 1);
    CHECK(publisher.demanding_subscribers() == 0);
    const Subscriber<Blob> tool(pair.right, kVolatile, "r1");
    CHECK(publisher.demanding_subscribers() == 1);
  }
  CHECK(publisher.matched_subscribers() == 0);
  CHECK(publisher.demanding_subscribers() == 0);
}

TEST_CASE("an offer below the request is reported to both sides and carries nothing",
          "[in-memory]") {
  Pair pair;
  const bool reliable = GENERATE(false, true);
  const Topic<Blob> offered{"/t", reliable ? kDefaultQos : kSensorQos};
  const Topic<Blob> requested{"/t", kLatchedQos};
  Publisher<Blob> publisher(pair.left, offered);
  Subscriber<Blob> subscriber(pair.right, requested);
  PublishIds(publisher, {1});
  CHECK(subscriber.Take().empty());
  CHECK(publisher.matched_subscribers() == 0);
  const std::string policy = reliable ? "durability" : "reliability";
  for (Participant* side : {&pair.left, &pair.right}) {
    const auto events = side->TakeEvents();
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == Event::Kind::kIncompatibleQos);
    CHECK(events[0].detail == policy);
  }
}

TEST_CASE("a message that convert refuses is counted, left out, and logged once", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Subscriber<Blob> subscriber(pair.right, kVolatile, "r1");
  std::vector<std::string> lines;
  log::SetSink([&lines](const log::Record& record) { lines.emplace_back(record.text); });
  PublishIds(publisher, {1, 2, 3, 4, 6});
  const auto only_odd = [](Blob&& blob) -> Result<std::uint64_t> {
    if (blob.id() % 2 == 1) return blob.id();
    return Fail(ErrorCode::kMalformed, "id is even");
  };
  CHECK(subscriber.TakeValid(only_odd) == std::vector<std::uint64_t>{1, 3});
  log::SetSink(nullptr);
  CHECK(subscriber.refused() == 3);
  REQUIRE(lines.size() == 1);
  CHECK_THAT(lines[0], Catch::Contains("/r1/volatile") && Catch::Contains("id is even"));
}

TEST_CASE("a message that cannot be serialised is refused", "[in-memory]") {
  Pair pair;
  Publisher<test::RawBlob> publisher(pair.left, Topic<test::RawBlob>{"/empty", kDefaultQos});
  const auto sent = publisher.Publish({});
  REQUIRE_FALSE(sent);
  CHECK(sent.error().code == ErrorCode::kMalformed);
}

TEST_CASE("a handler that throws misses that message alone", "[in-memory]") {
  Pair pair;
  std::vector<std::uint64_t> ids;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  {
    Subscriber<Blob> subscriber(pair.right, kVolatile, "r1", [&](Blob&& blob) {
      if (blob.id() == 1) throw std::runtime_error("not this one");
      ids.push_back(blob.id());
    });
    PublishIds(publisher, {1, 2});
  }  // and can be closed
  CHECK(ids == std::vector<std::uint64_t>{2});
}

TEST_CASE("a handler gets each message at once and may publish, also on its own topic",
          "[in-memory]") {
  Pair pair;
  std::vector<std::uint64_t> ids;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Subscriber<Blob> subscriber(pair.right, kVolatile, "r1", [&](Blob&& blob) {
    ids.push_back(blob.id());
    if (blob.id() < 4) PublishIds(publisher, {blob.id() + 1});
  });
  PublishIds(publisher, {1});
  CHECK(ids == std::vector<std::uint64_t>{1, 2, 3, 4});
  CHECK(subscriber.Take().empty());
}

TEST_CASE("Wait returns when something arrived since the last Wait", "[in-memory]") {
  Pair pair;
  Publisher<Blob> publisher(pair.left, kVolatile, "r1");
  Subscriber<Blob> subscriber(pair.right, kVolatile, "r1");
  CHECK_FALSE(pair.right.Wait(milliseconds(1)));
  PublishIds(publisher, {1});
  CHECK(pair.right.Wait(milliseconds(0)));
  CHECK_FALSE(pair.right.Wait(milliseconds(0)));
  CHECK_FALSE(pair.left.Wait(milliseconds(0)));
  pair.right.Wake();
  CHECK(pair.right.Wait(milliseconds(0)));
}

TEST_CASE("publishers on several threads lose nothing", "[in-memory]") {
  constexpr std::uint64_t kEach = 100;
  Pair pair;
  const Topic<Blob> topic{"/busy", kRequestQos};
  Subscriber<Blob> subscriber(pair.right, topic);
  Publisher<Blob> publisher(pair.left, topic);
  const auto publish = [&] {
    for (std::uint64_t i = 0; i < kEach; ++i) static_cast<void>(publisher.Publish({}));
  };
  std::thread first(publish);
  std::thread second(publish);
  first.join();
  second.join();
  CHECK(subscriber.Take().size() == 2 * kEach);
}

}  // namespace
}  // namespace conav::bus
