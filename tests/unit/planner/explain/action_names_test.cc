#include <catch2/catch.hpp>
#include <numbers>

#include "planner/explain/explanation.h"

namespace conav::planner {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

TEST_CASE("headings have the names of the compass where they have one", "[planner][explain]") {
  CHECK(HeadingName(0.0) == "east");
  CHECK(HeadingName(0.5 * kQuarter) == "north-east");
  CHECK(HeadingName(kQuarter) == "north");
  CHECK(HeadingName(-kQuarter) == "south");
  CHECK(HeadingName(3.5 * kQuarter) == "south-east");
  CHECK(HeadingName(4.0 * kQuarter) == "east");
  CHECK(HeadingName(kQuarter / 3.0) == "30 degrees");
}

TEST_CASE("moves are named by where they lead", "[planner][explain]") {
  CHECK(ActionName({.target = {1, 2}}, {2, 2}) == "move north to (1,2)");
  CHECK(ActionName({.target = {2, 1}}, {2, 2}) == "move west to (2,1)");
  CHECK(ActionName({.target = {7, 7}}, {2, 2}) == "move to (7,7)");
}

TEST_CASE("pictures are named by where they look", "[planner][explain]") {
  CHECK(ActionName({.kind = CommandKind::kTransmitView, .heading_rad = kQuarter}, {2, 2}) ==
        "picture to the north");
}

TEST_CASE("moves are the same by target, pictures by heading", "[planner][explain]") {
  const SearchAction move{.target = {1, 2}, .heading_rad = 1.0};
  const SearchAction view{.kind = CommandKind::kTransmitView, .heading_rad = 0.0};
  CHECK(IsSameCommand(move, {.target = {1, 2}}));
  CHECK_FALSE(IsSameCommand(move, {.target = {1, 3}}));
  CHECK(IsSameCommand(
      view, {.kind = CommandKind::kTransmitView, .target = {1, 1}, .heading_rad = 4.0 * kQuarter}));
  CHECK_FALSE(IsSameCommand(view, move));
}

}  // namespace
}  // namespace conav::planner
