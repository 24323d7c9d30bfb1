// Start-up of real participants: what cannot work is refused with its name, what can finds its
// peers.
#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/result.h"
#include "system/bus/peer_process.h"
#include "system/bus/peer_topics.h"

namespace conav::test {
namespace {

bus::ParticipantOptions Options() { return OnLoopback(GENERATE("cyclonedds", "fastdds")); }

TEST_CASE("participants find each other through a peer address alone", "[system][bus]") {
  bus::ParticipantOptions options = Options();
  options.interface.clear();
  options.peers = {"127.0.0.1"};
  const std::string other = GENERATE("cyclonedds", "fastdds");
  CAPTURE(Name(*options.vendor), other);
  const PeerProcess peer(other, "127.0.0.1");
  bus::Participant participant("bus_test", options);
  bus::Subscriber<Blob> history(participant, kHistory);
  CHECK(WaitUntil(participant, [&] { return !history.Take().empty(); }));
}

TEST_CASE("an interface that does not exist stops the start", "[system][bus]") {
  bus::ParticipantOptions options = Options();
  options.interface = "none0";
  CHECK_THROWS_WITH(bus::Participant("bus_test", options), Catch::Contains("none0"));
}

TEST_CASE("several participants of one process share a domain", "[system][bus]") {
  const bus::ParticipantOptions options = Options();
  CAPTURE(Name(*options.vendor));
  bus::Participant first("first", options);
  auto second = std::make_unique<bus::Participant>("second", options);
  bus::Subscriber<Blob> subscriber(first, kHistory);
  auto publisher = std::make_unique<bus::Publisher<Blob>>(*second, kHistory);
  REQUIRE(publisher->Publish(MakeBlob(1, 10)));
  CHECK(WaitUntil(first, [&] { return !subscriber.Take().empty(); }));
  publisher.reset();
  second.reset();
  CHECK(WaitUntil(first, [&] { return subscriber.matched_publishers() == 0; }));
}

/// Handing over within the publishing call would crash now and then: it also reaches participants
/// that are being destroyed.
TEST_CASE("Fast DDS gives a message to the same process to its receive thread", "[system][bus]") {
  bus::Participant sender("sender", OnLoopback("fastdds"));
  bus::Participant receiver("receiver", OnLoopback("fastdds"));
  std::atomic<bool> received = false;
  std::atomic<bool> on_this_thread = false;
  const auto here = std::this_thread::get_id();
  const bus::Subscriber<Blob> subscriber(receiver, kFlood, {}, [&](Blob&&) {
    if (std::this_thread::get_id() == here) on_this_thread = true;
    received = true;
  });
  bus::Publisher<Blob> publisher(sender, kFlood);
  CHECK(WaitUntil(sender, [&] { return publisher.Publish(MakeBlob(1, 10)) && received; }));
  CHECK_FALSE(on_this_thread);
}

TEST_CASE("two writers and two readers of one topic live in one participant", "[system][bus]") {
  const bus::ParticipantOptions options = Options();
  CAPTURE(Name(*options.vendor));
  bus::Participant participant("bus_test", options);
  bus::Publisher<Blob> first_writer(participant, kHistory);
  bus::Publisher<Blob> second_writer(participant, kHistory);
  bus::Subscriber<Blob> first_reader(participant, kHistory);
  {
    bus::Subscriber<Blob> second_reader(participant, kHistory);
    CHECK(WaitUntil(participant, [&] { return second_reader.matched_publishers() == 2; }));
  }
  REQUIRE(first_writer.Publish(MakeBlob(1, 10)));
  REQUIRE(second_writer.Publish(MakeBlob(2, 10)));
  std::size_t received = 0;
  CHECK(WaitUntil(participant, [&] { return (received += first_reader.Take().size()) == 2; }));
}

}  // namespace
}  // namespace conav::test
