#include "operator/console/command_log.h"

#include <catch2/catch.hpp>

namespace conav::operators {
namespace {

template <class Body>
console::Event Accepted(Body body) {
  const OperatorRequest request{{}, "anna", 7, "w1", std::move(body)};
  return EventOf(request, {"anna", 7, true, "", 3});
}

}  // namespace

TEST_CASE("a line of the command log tells who did what where", "[operator][console]") {
  const console::Event event = Accepted(GuideRequest{.robot = "r1", .path = {{1, 1}, {1, 2}}});
  CHECK(event.kind() == console::EVENT_GUIDE);
  CHECK(event.client() == "anna");
  CHECK(event.world() == "w1");
  CHECK(event.robot() == "r1");
  CHECK(event.revision() == 3);
  CHECK(event.text() == "drew a path of 2 cells");
}

TEST_CASE("one cell is no cells", "[operator][console]") {
  CHECK(EditText(1) == "edited 1 cell of the map");
  CHECK(EditText(2) == "edited 2 cells of the map");
  CHECK(PathText(0) == "removed the path");
  CHECK(PathText(1) == "drew a path of 1 cell");
}

TEST_CASE("who is stopped and let go is named, and why", "[operator][console]") {
  CHECK(Accepted(StopRequest{{"r1"}, "a cat"}).text() == "stopped r1: a cat");
  CHECK(Accepted(StopRequest{{"r1"}, "a cat"}).robot() == "r1");
  CHECK(Accepted(StopRequest{{}, ""}).text() == "stopped all robots");
  CHECK(Accepted(GoRequest{{"r1", "r2"}}).text() == "resumed r1, r2");
  CHECK(Accepted(GoRequest{{"r1", "r2"}}).robot().empty());
}

TEST_CASE("what was refused says what and why", "[operator][console]") {
  const OperatorRequest request{{}, "anna", 7, "w1", AnswerRequest{"r1", 4}};
  const console::Event event = EventOf(request, {"anna", 7, false, "r1 is bert's", 0});
  CHECK(event.kind() == console::EVENT_REFUSED);
  CHECK(event.robot() == "r1");
  CHECK(event.text() == "refused (picture 4: nothing new): r1 is bert's");
}

}  // namespace conav::operators
