#include "operator/gateway/snapshot_store.h"

#include <catch2/catch.hpp>

namespace conav::operators {
namespace {

std::vector<std::uint8_t> Pixels(std::size_t size, std::uint8_t value) {
  return std::vector<std::uint8_t>(size, value);
}

console::Frame FrameOf(const std::string& robot, const std::string& jpeg) {
  console::Frame frame;
  frame.set_robot(robot);
  frame.set_jpeg(jpeg);
  return frame;
}

TEST_CASE("a picture is found by robot and number", "[operator][gateway]") {
  SnapshotStore store(100);
  store.Put("r1", 1, Pixels(3, 'a'));
  store.Put("r2", 1, Pixels(2, 'b'));
  REQUIRE(store.Find("r1", 1));
  CHECK(*store.Find("r1", 1) == Pixels(3, 'a'));
  CHECK(*store.Find("r2", 1) == Pixels(2, 'b'));
  CHECK_FALSE(store.Find("r1", 2));
  CHECK_FALSE(store.Find("r3", 1));
}

TEST_CASE("a picture without pixels is not kept", "[operator][gateway]") {
  SnapshotStore store(100);
  store.Put("r1", 1, {});
  CHECK_FALSE(store.Find("r1", 1));
}

TEST_CASE("the oldest pictures leave first", "[operator][gateway]") {
  SnapshotStore store(10);
  for (std::uint64_t number = 1; number <= 3; ++number) store.Put("r1", number, Pixels(4, 'a'));
  CHECK_FALSE(store.Find("r1", 1));
  CHECK(store.Find("r1", 2));
  CHECK(store.Find("r1", 3));
  store.Put("r1", 4, Pixels(10, 'a'));
  CHECK_FALSE(store.Find("r1", 3));
  CHECK(store.Find("r1", 4));
}

TEST_CASE("a picture beyond the limit is not kept, and costs no other one", "[operator][gateway]") {
  SnapshotStore store(10);
  store.Put("r1", 1, Pixels(4, 'a'));
  store.Put("r1", 2, Pixels(11, 'a'));
  CHECK(store.Find("r1", 1));
  CHECK_FALSE(store.Find("r1", 2));
}

TEST_CASE("a picture of the same number takes the place of the one before", "[operator][gateway]") {
  SnapshotStore store(10);
  store.Put("r1", 1, Pixels(6, 'a'));
  const auto before = store.Find("r1", 1);
  store.Put("r1", 1, Pixels(6, 'b'));
  CHECK(*store.Find("r1", 1) == Pixels(6, 'b'));
  CHECK(*before == Pixels(6, 'a'));  // who sends it still has it
  store.Put("r2", 1, Pixels(4, 'c'));
  CHECK(store.Find("r1", 1));
}

TEST_CASE("slots hold the newest frame of each robot", "[operator][gateway]") {
  FrameSlots slots;
  CHECK(slots.Newer({}).empty());
  slots.Put(FrameOf("r1", "a"));
  slots.Put(FrameOf("r2", "b"));
  slots.Put(FrameOf("r1", "c"));
  const auto newest = slots.Newer({});
  REQUIRE(newest.size() == 2);
  CHECK(newest.at("r1").frame->jpeg() == "c");
  CHECK(newest.at("r1").number == 2);
  CHECK(newest.at("r1").frame->number() == 2);
  CHECK(newest.at("r2").number == 1);
  CHECK(slots.Numbers() == std::map<std::string, std::uint64_t>{{"r1", 2}, {"r2", 1}});
}

TEST_CASE("a page that has a frame does not get it again", "[operator][gateway]") {
  FrameSlots slots;
  slots.Put(FrameOf("r1", "a"));
  slots.Put(FrameOf("r2", "b"));
  CHECK(slots.Newer(slots.Numbers()).empty());
  CHECK(slots.Newer({{"r1", 1}}).size() == 1);
}

TEST_CASE("a frame that is being sent outlives its slot", "[operator][gateway]") {
  FrameSlots slots;
  slots.Put(FrameOf("r1", "a"));
  const auto taken = slots.Newer({}).at("r1").frame;
  slots.Put(FrameOf("r1", "b"));
  CHECK(taken->jpeg() == "a");
}

}  // namespace
}  // namespace conav::operators
