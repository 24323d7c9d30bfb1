#include "common/bus/intake.h"

#include <catch2/catch.hpp>

#include "support/test_messages.h"

namespace conav::bus {
namespace {

using conav_test::msg::Blob;

const EndpointOptions kBlobs{"/blobs", TypeSupportOf<Blob>(), kDefaultQos};

std::vector<std::uint8_t> Payload(std::uint64_t id, std::size_t size) {
  const Blob blob = test::MakeBlob(id, size);
  std::vector<std::uint8_t> payload(kBlobs.type.serialized_size(&blob));
  kBlobs.type.serialize(&blob, payload);
  return payload;
}

TEST_CASE("a payload reaches the sink as a message, memory is used again", "[intake]") {
  EventLog events;
  std::vector<const std::uint8_t*> places;
  std::vector<Blob> received;
  Intake intake(
      kBlobs,
      [&](void* message, const Origin&) {
        received.push_back(*static_cast<Blob*>(message));
        places.push_back(static_cast<Blob*>(message)->data().data());
      },
      events);
  intake.Deliver(Payload(1, 500), {});
  intake.Deliver(Payload(2, 400), {});
  CHECK(received == std::vector<Blob>{test::MakeBlob(1, 500), test::MakeBlob(2, 400)});
  CHECK(places[0] == places[1]);
}

TEST_CASE("a malformed payload is dropped and counted", "[intake]") {
  EventLog events;
  int received = 0;
  Intake intake(
      kBlobs, [&](void*, const Origin&) { ++received; }, events);
  intake.Deliver(std::vector<std::uint8_t>{0, 1, 0, 0, 5}, {});
  CHECK(received == 0);
  CHECK(intake.malformed() == 1);
  intake.Deliver(Payload(1, 5), {});
  CHECK(received == 1);
  CHECK(intake.malformed() == 1);
}

TEST_CASE("a sink may cause another delivery to itself", "[intake]") {
  EventLog events;
  std::vector<std::uint64_t> ids;
  Intake* self = nullptr;
  Intake intake(
      kBlobs,
      [&](void* message, const Origin&) {
        ids.push_back(static_cast<Blob*>(message)->id());
        if (ids.size() == 1) self->Deliver(Payload(2, 5), {});
        ids.push_back(static_cast<Blob*>(message)->id());
      },
      events);
  self = &intake;
  intake.Deliver(Payload(1, 5), {});
  CHECK(ids == std::vector<std::uint64_t>{1, 2, 2, 1});
}

const Guid kFirst = {1};
const Guid kSecond = {2};

TEST_CASE("a stamp is new once per writer, also of a clock that was set back", "[deduplicator]") {
  Deduplicator seen;
  CHECK(seen.IsNew(kFirst, 10));
  CHECK_FALSE(seen.IsNew(kFirst, 10));
  CHECK(seen.IsNew(kSecond, 10));
  CHECK_FALSE(seen.IsNew(kFirst, 10));
  for (std::int64_t stamp = 1000; stamp < 3000; ++stamp) REQUIRE(seen.IsNew(kFirst, stamp));
  CHECK(seen.IsNew(kFirst, 500));
  CHECK_FALSE(seen.IsNew(kFirst, 500));
}

TEST_CASE("what is remembered of a writer is little more than its history", "[deduplicator]") {
  constexpr int kDepth = 1;
  Deduplicator seen(kDepth);
  for (std::int64_t stamp = 0; stamp < 10000; ++stamp) REQUIRE(seen.IsNew(kFirst, stamp));
  CHECK_FALSE(seen.IsNew(kFirst, 10000 - kDepth));
  CHECK(seen.bytes() <= (kDepth + Deduplicator::kMargin) * sizeof(std::int64_t));
}

TEST_CASE("a whole repeated history is recognised, and what follows is new", "[deduplicator]") {
  Deduplicator seen;
  constexpr auto kHistory = static_cast<std::int64_t>(Deduplicator::kWindow);
  for (std::int64_t stamp = 0; stamp < 3 * kHistory; ++stamp) REQUIRE(seen.IsNew(kFirst, stamp));
  for (std::int64_t stamp = 2 * kHistory; stamp < 3 * kHistory; ++stamp) {
    REQUIRE_FALSE(seen.IsNew(kFirst, stamp));
  }
  CHECK(seen.IsNew(kFirst, 3 * kHistory));
}

TEST_CASE("the writer unused for longest is forgotten when there are too many", "[deduplicator]") {
  Deduplicator seen;
  CHECK(seen.IsNew(kFirst, 1));
  for (std::size_t i = 0; i < Deduplicator::kWriters; ++i) {
    const Guid writer = {7, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)};
    REQUIRE(seen.IsNew(writer, 1));
    if (i == 3) CHECK_FALSE(seen.IsNew(kFirst, 1));
  }
  CHECK(seen.IsNew({7, 0, 0}, 1));
}

}  // namespace
}  // namespace conav::bus
