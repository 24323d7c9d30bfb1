#include <catch2/catch.hpp>

#include "operator/gateway/picture_store.h"

namespace conav::operators {
namespace {

std::vector<std::uint8_t> Pixels(std::size_t size, std::uint8_t value) {
  return std::vector<std::uint8_t>(size, value);
}

}  // namespace

TEST_CASE("a picture is found by robot and number", "[operator][gateway]") {
  SnapshotStore shelf(100);
  shelf.Put("r1", 1, Pixels(3, 'a'));
  shelf.Put("r2", 1, Pixels(2, 'b'));
  REQUIRE(shelf.Find("r1", 1));
  CHECK(*shelf.Find("r1", 1) == "aaa");
  CHECK(*shelf.Find("r2", 1) == "bb");
  CHECK_FALSE(shelf.Find("r1", 2));
  CHECK_FALSE(shelf.Find("r3", 1));
}

TEST_CASE("a picture without pixels is not kept", "[operator][gateway]") {
  SnapshotStore shelf(100);
  shelf.Put("r1", 1, {});
  CHECK_FALSE(shelf.Find("r1", 1));
}

TEST_CASE("the oldest pictures leave first", "[operator][gateway]") {
  SnapshotStore shelf(10);
  for (std::uint64_t number = 1; number <= 3; ++number) shelf.Put("r1", number, Pixels(4, 'a'));
  CHECK_FALSE(shelf.Find("r1", 1));
  CHECK(shelf.Find("r1", 2));
  CHECK(shelf.Find("r1", 3));
  shelf.Put("r1", 4, Pixels(10, 'a'));
  CHECK_FALSE(shelf.Find("r1", 3));
  CHECK(shelf.Find("r1", 4));
}

TEST_CASE("a picture beyond the limit is not kept, and costs no other one", "[operator][gateway]") {
  SnapshotStore shelf(10);
  shelf.Put("r1", 1, Pixels(4, 'a'));
  shelf.Put("r1", 2, Pixels(11, 'a'));
  CHECK(shelf.Find("r1", 1));
  CHECK_FALSE(shelf.Find("r1", 2));
}

TEST_CASE("a picture of the same number takes the place of the one before", "[operator][gateway]") {
  SnapshotStore shelf(10);
  shelf.Put("r1", 1, Pixels(6, 'a'));
  const auto before = shelf.Find("r1", 1);
  shelf.Put("r1", 1, Pixels(6, 'b'));
  CHECK(*shelf.Find("r1", 1) == "bbbbbb");
  CHECK(*before == "aaaaaa");  // who sends it still has it
  shelf.Put("r2", 1, Pixels(4, 'c'));
  CHECK(shelf.Find("r1", 1));
}

}  // namespace conav::operators
