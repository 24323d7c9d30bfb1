#include <catch2/catch.hpp>

#include "common/bus/topics.h"
#include "common/bus/type_support_of.h"
#include "support/test_messages.h"

namespace conav::bus {
namespace {

using conav_test::msg::Blob;
using conav_test::msg::KeyedBlob;

std::vector<std::uint8_t> Serialised(const TypeSupport& type, const void* message) {
  std::vector<std::uint8_t> payload(type.serialized_size(message));
  payload.resize(type.serialize(message, payload));
  return payload;
}

TEST_CASE("type names are those that ROS 2 gives its types in DDS, without keys", "[types]") {
  CHECK(TypeSupportOf<conav_msgs::msg::RobotState>().name == "conav_msgs::msg::dds_::RobotState_");
  CHECK_FALSE(TypeSupportOf<conav_msgs::msg::RobotState>().keyed);
  CHECK_FALSE(TypeSupportOf<nav_msgs::msg::Path>().keyed);
}

TEST_CASE("a message is serialised as little-endian CDR with encapsulation", "[types]") {
  Blob blob;
  blob.id(0x0102);
  blob.data({7, 8, 9});
  const std::vector<std::uint8_t> expected = {0, 1, 0, 0, 2, 1, 0, 0, 0, 0,
                                              0, 0, 3, 0, 0, 0, 7, 8, 9};
  CHECK(Serialised(TypeSupportOf<Blob>(), &blob) == expected);
}

TEST_CASE("a serialised message comes back equal, a buffer that is too small is refused",
          "[types]") {
  const Blob sent = test::MakeBlob(5, 1000);
  Blob received;
  const auto& type = TypeSupportOf<Blob>();
  REQUIRE(type.deserialize(Serialised(type, &sent), &received));
  CHECK(received == sent);
  std::vector<std::uint8_t> payload(type.serialized_size(&sent) - 1);
  CHECK(type.serialize(&sent, payload) == 0);
}

TEST_CASE("payloads that are no message are refused", "[types]") {
  const auto& type = TypeSupportOf<Blob>();
  const Blob blob = test::MakeBlob(5, 16);
  std::vector<std::uint8_t> payload = Serialised(type, &blob);
  Blob received;
  SECTION("empty") { payload.clear(); }
  SECTION("only an encapsulation") { payload.resize(4); }
  SECTION("cut short") { payload.pop_back(); }
  SECTION("a sequence longer than the payload") { payload[15] = 0xf0; }
  SECTION("another encapsulation") { payload[1] = 7; }
  CHECK_FALSE(type.deserialize(payload, &received));
}

TEST_CASE("big-endian payloads are read", "[types]") {
  const std::vector<std::uint8_t> payload = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1, 9};
  Blob received;
  REQUIRE(TypeSupportOf<Blob>().deserialize(payload, &received));
  CHECK(received.id() == 0x0102);
  CHECK(received.data() == std::vector<std::uint8_t>{9});
}

TEST_CASE("the key of a keyed type is its key members in big-endian order", "[types]") {
  const auto& type = TypeSupportOf<KeyedBlob>();
  REQUIRE(type.keyed);
  const KeyedBlob blob = test::MakeKeyedBlob(0x01020304, 9, 10);
  std::array<std::uint8_t, kMaximumKeySize> key{};
  REQUIRE(type.serialize_key(&blob, key) == 4);
  CHECK(key[0] == 1);
  CHECK(key[3] == 4);
}

}  // namespace
}  // namespace conav::bus
