#include "operator/console/command_log.h"

#include <catch2/catch.hpp>
#include <string>

#include "console.pb.h"

namespace conav::operators {
namespace {

template <class Body>
console::Event Accepted(Body body) {
  const OperatorRequest request{{}, "anna", 7, "w1", std::move(body)};
  return EventOf(request, {"anna", 7, true, "", 3});
}

constexpr std::size_t kMessage = 512 * 1024;

void Write(console::Cell* cell) {
  cell->set_row(1023);
  cell->set_column(1023);
}

console::ClientMessage MessageOf(console::Request request) {
  console::ClientMessage message;
  request.set_id(~std::uint64_t{0});
  request.set_valid_until(1e9);
  request.set_world(std::string(64, 'w'));
  *message.mutable_request() = std::move(request);
  return message;
}

TEST_CASE("a line of the command log has client, action and place", "[operator][console]") {
  const console::Event event = Accepted(GuideRequest{.robot = "r1", .path = {{1, 1}, {1, 2}}});
  CHECK(event.kind() == console::EVENT_GUIDE);
  CHECK(event.client() == "anna");
  CHECK(event.world() == "w1");
  CHECK(event.robot() == "r1");
  CHECK(event.revision() == 3);
  CHECK_THAT(event.text(), Catch::Contains("2 cells"));
  CHECK(Accepted(StopRequest{{"r1"}, ""}).robot() == "r1");
  CHECK(Accepted(ResumeRequest{{"r1", "r2"}}).robot().empty());
}

TEST_CASE("a line of the command log names cells, robots and the reason", "[operator][console]") {
  const auto [text, named] = GENERATE(table<std::string, std::string>({
      {EditText(1), "1 cell "},
      {EditText(2), "2 cells "},
      {PathText(0), "removed"},
      {PathText(1), "1 cell"},
      {Accepted(StopRequest{{"r1"}, "a cat"}).text(), "r1: a cat"},
      {Accepted(StopRequest{{}, ""}).text(), "all robots"},
      {Accepted(ResumeRequest{{"r1", "r2"}}).text(), "r1, r2"},
  }));
  CHECK_THAT(text, Catch::Contains(named));
}

TEST_CASE("a refusal names the request and the reason", "[operator][console]") {
  const OperatorRequest request{{}, "anna", 7, "w1", AnswerRequest{"r1", 4}};
  const console::Event event = EventOf(request, {"anna", 7, false, "bert's", 0});
  CHECK(event.kind() == console::EVENT_REFUSED);
  CHECK(event.robot() == "r1");
  CHECK_THAT(event.text(), Catch::Contains("picture 4") && Catch::Contains("bert's"));
}

TEST_CASE(
    "An edit and a path of as many cells as allowed fit into a message, within the options'"
    " limits",
    "[operator][console]") {
  const RequestLimits limits = LimitsOf(kMessage, {65536, 65536});
  console::Request edit;
  edit.mutable_edit()->set_base_revision(~std::uint64_t{0});
  for (std::uint32_t i = 0; i < limits.edit_cells; ++i) {
    console::CellEdit* cell = edit.mutable_edit()->add_cells();
    cell->set_wall(true);
    Write(cell->mutable_cell());
  }
  CHECK(MessageOf(edit).ByteSizeLong() <= kMessage);
  console::Request guide;
  guide.mutable_guide()->set_robot(std::string(64, 'r'));
  for (std::uint32_t i = 0; i < limits.path_cells; ++i) Write(guide.mutable_guide()->add_path());
  CHECK(MessageOf(guide).ByteSizeLong() <= kMessage);
  CHECK(limits.edit_cells > 40'000);  // all of a map of 150 x 150 twice over
  CHECK(LimitsOf(kMessage, {100, 200}) == RequestLimits{100, 200});
  CHECK(LimitsOf(100, {100, 200}) == RequestLimits{0, 0});
}

}  // namespace
}  // namespace conav::operators
