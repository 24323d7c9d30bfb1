#include "operator/supervision/command_log.h"

#include <catch2/catch.hpp>
#include <string>

namespace conav::operators {
namespace {

template <class Body>
OperatorEvent Accepted(Body body) {
  const OperatorRequest request{{}, "anna", 7, "w1", std::move(body)};
  return EventOf(request, {"anna", 7, true, "", 3}, SimTime::FromSeconds(2.0));
}

TEST_CASE("a line of the command log has client, action and place", "[operator]") {
  const OperatorEvent event = Accepted(GuideRequest{.robot = "r1", .path = {{1, 1}, {1, 2}}});
  CHECK(event == OperatorEvent{SimTime::FromSeconds(2.0), RequestKind::kGuide, true, "anna", "w1",
                               "r1", PathText(2), 2, 3});
  CHECK(Accepted(ResumeRequest{{"r1", "r2"}}).robot.empty());
  CHECK(Accepted(EditRequest{0, {{{1, 1}, true}}}).cells == 1);
}

TEST_CASE("a line of the command log names cells, robots and the reason", "[operator]") {
  const auto [text, named] = GENERATE(table<std::string, std::string>({
      {Accepted(EditRequest{0, {{{1, 1}, true}}}).text, "1 cell "},
      {PathText(0), "removed"},
      {PathText(2), "2 cells"},
      {Accepted(StopRequest{{"r1"}, "a cat"}).text, "r1: a cat"},
      {Accepted(ResumeRequest{{"r1", "r2"}}).text, "r1, r2"},
      {Accepted(TakeControlRequest{{"r1"}, "lunch", true}).text, "asked for control of r1: lunch"},
      {Accepted(NoteRequest{"the door was open"}).text, "the door was open"},
  }));
  CHECK_THAT(text, Catch::Contains(named));
}

TEST_CASE("a refusal names the request and the reason", "[operator]") {
  const OperatorRequest request{{}, "anna", 7, "w1", AnswerRequest{"r1", 4}};
  const auto event = EventOf(request, {"anna", 7, false, "bert's" + std::string(4096, '.'), 0}, {});
  CHECK((event.robot == "r1" && !event.accepted && event.text.size() == 4096));
  CHECK_THAT(event.text, Catch::Contains("picture 4") && Catch::Contains("bert's"));
}

}  // namespace
}  // namespace conav::operators
