#include <catch2/catch.hpp>

#include "operator/gateway/picture_store.h"

namespace conav::operators {
namespace {

console::Frame FrameOf(const std::string& robot, const std::string& jpeg) {
  console::Frame frame;
  frame.set_robot(robot);
  frame.set_jpeg(jpeg);
  return frame;
}

}  // namespace

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

TEST_CASE("who has seen a frame gets it no more", "[operator][gateway]") {
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

}  // namespace conav::operators
