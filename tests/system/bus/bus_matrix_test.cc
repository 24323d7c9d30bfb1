// Every pair of vendors, in two processes over real sockets on the loopback interface.
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <optional>

#include "common/bus/backend.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "system/bus/peer_process.h"
#include "system/bus/peer_topics.h"

namespace conav::test {
namespace {

using bus::Event;
using bus::Participant;
using bus::Publisher;
using bus::Subscriber;

/// A participant here and a peer process there, for each pair of vendors.
struct VendorPair {
  std::string here = GENERATE("cyclonedds", "fastdds");
  std::string there = GENERATE("cyclonedds", "fastdds");
  PeerProcess peer{there};
  Participant participant{"bus_test", OnLoopback(here)};
};

template <class T>
struct EchoClient {
  EchoClient(Participant& on, const bus::Topic<T>& ping, const bus::Topic<T>& pong)
      : participant(on), publisher(on, ping), subscriber(on, pong) {}

  /// Pings until the peer has answered for half a second. Volatile topics promise nothing before
  /// both sides know of each other: Cyclone takes all up to the first heartbeat of a writer for
  /// history, and Fast DDS sends that heartbeat up to 0.1 s after its first samples.
  bool Connect(const T& message) {
    const auto settled = std::chrono::milliseconds(500);
    std::optional<std::chrono::steady_clock::time_point> first_answer;
    return WaitUntil(participant, [&] {
      if (!publisher.Publish(message) || subscriber.Take().empty()) return false;
      const auto now = std::chrono::steady_clock::now();
      if (!first_answer) first_answer = now;
      return now - *first_answer > settled;
    });
  }

  /// Sends once; the next new message that comes back.
  T RoundTrip(const T& message) {
    T answer;
    if (!publisher.Publish(message)) return answer;
    WaitUntil(participant, [&] {
      const auto taken = subscriber.Take();
      const auto found = std::find_if(taken.begin(), taken.end(),
                                      [&](const T& other) { return other.id() == message.id(); });
      if (found != taken.end()) answer = *found;
      return found != taken.end();
    });
    return answer;
  }

  Participant& participant;
  Publisher<T> publisher;
  Subscriber<T> subscriber;
};

bool Has(const std::vector<Event>& events, Event::Kind kind, const std::string& topic) {
  return std::any_of(events.begin(), events.end(), [&](const Event& event) {
    return event.kind == kind && event.topic == topic;
  });
}

/// Collects the participant's events until one of that kind came for the topic.
bool WaitForEvent(Participant& participant, Event::Kind kind, const std::string& topic) {
  return WaitUntil(participant, [&] { return Has(participant.TakeEvents(), kind, topic); });
}

/// `make(id, size)`: a message of that payload.
template <class T, class Make>
void CheckRoundTrips(const bus::Topic<T>& ping, const bus::Topic<T>& pong, Make make) {
  VendorPair pair;
  CAPTURE(pair.here, pair.there);
  EchoClient<T> client(pair.participant, ping, pong);
  REQUIRE(client.Connect(make(1, 8)));
  std::uint64_t id = 100;
  for (const std::size_t size : {64u, 20'000u, 200'000u, 2'000'000u}) {
    for (int i = 0; i < 3; ++i) {
      const T sent = make(++id, size);
      CAPTURE(size, id);
      REQUIRE(client.RoundTrip(sent) == sent);
    }
  }
}

TEST_CASE("unkeyed messages of all sizes go to the peer and back unchanged", "[system][bus]") {
  CheckRoundTrips(kPing, kPong, MakeBlob);
}

TEST_CASE("keyed messages of all sizes go to the peer and back unchanged", "[system][bus]") {
  CheckRoundTrips(kKeyedPing, kKeyedPong, [](std::uint64_t id, std::size_t size) {
    constexpr std::int32_t kInstances[] = {1, -2, 70'000};
    return MakeKeyedBlob(kInstances[id % 3], id, size);
  });
}

TEST_CASE("a late joiner gets exactly the last samples of the history", "[system][bus]") {
  VendorPair pair;
  CAPTURE(pair.here, pair.there);
  Subscriber<Blob> history(pair.participant, kHistory);
  std::vector<Blob> received;
  const auto take = [&] {
    for (Blob& blob : history.Take()) received.push_back(std::move(blob));
    return !received.empty() && received.back().id() == kHistoryPublished;
  };
  REQUIRE(WaitUntil(pair.participant, take));
  CHECK(history.Take().empty());
  REQUIRE(received.size() == kHistoryDepth);
  for (std::size_t i = 0; i < received.size(); ++i) {
    CHECK(received[i] == MakeBlob(kHistoryPublished - kHistoryDepth + 1 + i, 1000));
  }
}

/// When the newest samples of the history were published, for a subscriber that joins now.
std::vector<bus::SourceTime> SourceTimes(Participant& participant) {
  Subscriber<Blob> history(participant, kHistory);
  std::vector<bus::SourceTime> times;
  const bool complete = WaitUntil(participant, [&] {
    for (const auto& taken : history.TakeStamped()) times.push_back(taken.source);
    return times.size() >= kHistoryDepth;
  });
  REQUIRE(complete);
  return times;
}

TEST_CASE("a late joiner learns when a sample was published, not when it came", "[system][bus]") {
  const auto before = std::chrono::system_clock::now();
  VendorPair pair;
  CAPTURE(pair.here, pair.there);
  const auto first = SourceTimes(pair.participant);
  const auto after = std::chrono::system_clock::now();
  CHECK(first.front() > before);
  CHECK(first.back() < after);
  CHECK(SourceTimes(pair.participant) == first);
}

TEST_CASE("malformed payloads are dropped and counted, the next message arrives", "[system][bus]") {
  VendorPair pair;
  CAPTURE(pair.here, pair.there);
  Subscriber<Blob> subscriber(pair.participant, kAfterGarbage);
  std::vector<Blob> received;
  REQUIRE(WaitUntil(pair.participant, [&] {
    for (Blob& blob : subscriber.Take()) received.push_back(std::move(blob));
    return !received.empty() && subscriber.malformed() >= kGarbagePublished;
  }));
  CHECK(received == std::vector<Blob>{MakeBlob(1, 10)});
  CHECK(subscriber.malformed() == kGarbagePublished);
}

TEST_CASE("incompatible QoS is reported to the reader and to the writer", "[system][bus]") {
  VendorPair pair;
  CAPTURE(pair.here, pair.there);
  const bus::Topic<Blob> reliable{kBestEffortOffer.pattern, bus::kDefaultQos};
  const bus::Topic<Blob> best_effort{kReliableRequest.pattern, bus::kSensorQos};
  Subscriber<Blob> subscriber(pair.participant, reliable);
  CHECK(WaitForEvent(pair.participant, Event::Kind::kIncompatibleQos, "/test/offer"));
  Publisher<Blob> publisher(pair.participant, best_effort);
  CHECK(WaitForEvent(pair.participant, Event::Kind::kIncompatibleQos, "/test/request"));
  CHECK(subscriber.matched_publishers() == 0);
  CHECK(publisher.matched_subscribers() == 0);
}

TEST_CASE("a publisher knows which subscribers ask for the full rate, of either vendor",
          "[system][bus]") {
  const std::string here = GENERATE("cyclonedds", "fastdds");
  const std::string there = GENERATE("cyclonedds", "fastdds");
  CAPTURE(here, there);
  const bus::Topic<Blob> topic{"/test/demand", bus::kDefaultQos};
  Participant publishing("bus_test_publisher", OnLoopback(here));
  Publisher<Blob> publisher(publishing, topic);
  Participant subscribing("bus_test_subscriber", OnLoopback(there));
  const Subscriber<Blob> recorder(subscribing, bus::Sparse(topic));
  REQUIRE(WaitUntil(publishing, [&] { return publisher.matched_subscribers() == 1; }));
  CHECK(publisher.demanding_subscribers() == 0);
  {
    const Subscriber<Blob> tool(subscribing, topic);
    CHECK(WaitUntil(publishing, [&] { return publisher.demanding_subscribers() == 1; }));
    CHECK(publisher.matched_subscribers() == 2);
  }
  CHECK(WaitUntil(publishing, [&] { return publisher.matched_subscribers() == 1; }));
  CHECK(publisher.demanding_subscribers() == 0);
}

// The faults report's S12: "Two systems in one domain with the same names (no attacker, a colleague): maps of
// one reach the other's operator".
TEST_CASE("two systems in one domain notice each other and take none of each other's messages",
          "[system][bus]") {
  const std::string here = GENERATE("cyclonedds", "fastdds");
  const std::string there = GENERATE("cyclonedds", "fastdds");
  CAPTURE(here, there);
  const auto of_system = [](const std::string& vendor, const std::string& system) {
    bus::ParticipantOptions options = OnLoopback(vendor);
    options.system = system;
    return options;
  };
  const bus::Topic<Blob> topic{"/test/systems", bus::kEventQos};
  Participant ours("bus_test_ours", of_system(here, "ours"));
  Participant theirs("bus_test_theirs", of_system(there, "theirs"));
  Subscriber<Blob> our_reader(ours, topic);
  Subscriber<Blob> their_reader(theirs, topic);
  Publisher<Blob> our_writer(ours, topic);
  Publisher<Blob> their_writer(theirs, topic);
  // A program that names no system, as of ROS 2; not resolved, which would name one.
  bus::ParticipantOptions foreign = bus::Resolve(OnLoopback(here));
  foreign.system.clear();
  const auto backend = foreign.vendor == bus::Vendor::kFastDds
                           ? bus::MakeFastBackend("bus_test_foreign", foreign)
                           : bus::MakeCycloneBackend("bus_test_foreign", foreign);
  const auto foreign_writer =
      backend->CreateWriter({"/test/systems", bus::TypeSupportOf<Blob>(), topic.qos});

  REQUIRE(our_writer.Publish(MakeBlob(1, 10)));
  REQUIRE(their_writer.Publish(MakeBlob(2, 10)));
  const Blob from_foreign = MakeBlob(3, 10);
  REQUIRE(foreign_writer->Write(&from_foreign));
  const auto takes = [](Participant& participant, Subscriber<Blob>& reader,
                        const std::vector<std::uint64_t>& expected) {
    std::vector<std::uint64_t> ids;
    const bool all = WaitUntil(participant, [&] {
      for (const Blob& blob : reader.Take()) ids.push_back(blob.id());
      return ids.size() >= expected.size() && reader.matched_publishers() == 3;
    });
    std::sort(ids.begin(), ids.end());
    return all && ids == expected;
  };
  CHECK(takes(ours, our_reader, {1, 3}));
  CHECK(takes(theirs, their_reader, {2, 3}));
  const auto meets = [](Participant& participant, const std::string& system) {
    int met = 0;
    for (const Event& event : participant.TakeEvents()) {
      if (event.kind == Event::Kind::kOtherSystem && event.detail == system) ++met;
    }
    return met;
  };
  CHECK(meets(ours, "theirs") == 1);
  CHECK(meets(theirs, "ours") == 1);
  CHECK(our_reader.Take().empty());
}

TEST_CASE("a peer that was killed is noticed within its lease, one that ends says goodbye",
          "[system][bus]") {
  VendorPair pair;
  const bool killed = GENERATE(true, false);
  CAPTURE(pair.here, pair.there, killed);
  Subscriber<Blob> subscriber(pair.participant, kPong);
  REQUIRE(WaitForEvent(pair.participant, Event::Kind::kMatched, "/test/pong"));
  CHECK(subscriber.matched_publishers() == 1);
  if (killed) pair.peer.Kill();
  if (!killed) CHECK(pair.peer.Wait() == 0);
  CHECK(WaitForEvent(pair.participant, Event::Kind::kUnmatched, "/test/pong"));
  CHECK(subscriber.matched_publishers() == 0);
}

TEST_CASE("a writer that hangs loses its liveliness", "[system][bus]") {
  const PeerProcess peer("cyclonedds");
  Participant participant("bus_test", OnLoopback("cyclonedds"));
  Subscriber<Blob> subscriber(participant, kShortLease);
  REQUIRE(WaitForEvent(participant, Event::Kind::kLivelinessGained, "/test/short_lease"));
  peer.Signal(SIGSTOP);
  CHECK(WaitForEvent(participant, Event::Kind::kLivelinessLost, "/test/short_lease"));
}

TEST_CASE("a message that cannot be serialised is refused as such", "[system][bus]") {
  Participant participant("bus_test", OnLoopback(GENERATE("cyclonedds", "fastdds")));
  Publisher<RawBlob> publisher(participant, kGarbage);
  const auto sent = publisher.Publish({});
  REQUIRE_FALSE(sent);
  CHECK(sent.error().code == ErrorCode::kMalformed);
  CHECK_THAT(sent.error().text, Catch::Contains("/test/garbage"));
}

}  // namespace
}  // namespace conav::test
