#include "operator/replay/timeline.h"
#include "unit/operator/replay/run_bench.h"

namespace conav::operators {
namespace {

std::vector<console::Event> EventsOf(const Timeline& timeline) {
  std::vector<console::Event> events;
  for (const Moment& moment : timeline.moments) {
    if (const auto* event = std::get_if<console::Event>(&moment.value)) events.push_back(*event);
  }
  return events;
}

TEST_CASE("a run's marks come from pictures, edits, paths and goals", "[operator][replay]") {
  const Timeline run = SmallRun();
  CHECK(run.duration_s == 10.0);
  CHECK(KindsOf(run) == std::vector{console::MARK_SNAPSHOT, console::MARK_EDIT,
                                    console::MARK_GUIDANCE, console::MARK_GOAL,
                                    console::MARK_SNAPSHOT, console::MARK_GUIDANCE});
  CHECK(run.marks[1].position() == 4.0);
  CHECK_THAT(run.marks[1].text(), Catch::Contains("revision 1") && Catch::Contains("anna/1"));
  CHECK(run.marks[3].robot() == "r1");
  CHECK_THAT(run.marks[3].text(), Catch::Contains("1 of 2"));
  CHECK_THAT(run.marks[5].text(), Catch::Contains("picture 2"));
  CHECK(run.began_s == kBegin);
}

TEST_CASE("a run begins with its world, actions before the recording are no events of it",
          "[operator][replay]") {
  TimelineBuilder before(SessionOfOne());
  before.Receive(kBegin, BeliefOf(7, 1.0F));
  before.Receive(kBegin, PathOf(4, {{1, 1}}, 3));
  const Timeline begun = std::move(before).Finish();
  CHECK(begun.moments.size() == 2);
  CHECK(begun.marks.empty());
  TimelineBuilder builder(SessionOfOne());
  builder.Receive(kBegin, ServiceHealth{"sim", console::LEVEL_OK, "starts"});
  builder.Receive(kBegin + 3.0, BeliefOf(0, 0.0F));
  builder.Receive(kBegin + 4.0, ServiceHealth{"sim", console::LEVEL_OK, "runs"});
  const Timeline run = std::move(builder).Finish();
  CHECK(run.moments[1].position_s == 0.0);
  CHECK(run.duration_s == 1.0);
}

TEST_CASE("what a run shows of commands and processes", "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  SECTION("the command log comes from the operator service's events, notes are marks") {
    OperatorEvent event = samples::SampleEvent();  // refused
    builder.Receive(kBegin, BeliefOf(0, 0.0F));
    builder.Receive(kBegin + 1.0, event);
    event.kind = RequestKind::kNote;
    event.accepted = true;
    event.text = "the door was open";
    builder.Receive(kBegin + 3.0, event);
    const Timeline run = std::move(builder).Finish();
    const auto events = EventsOf(run);
    REQUIRE(events.size() == 2);
    CHECK(events[0].kind() == console::EVENT_REFUSED);
    CHECK(events[0].time() == kBegin + 1.0);
    REQUIRE(KindsOf(run) == std::vector{console::MARK_NOTE});
    CHECK(run.marks[0].text() == event.text);
    CHECK(run.marks[0].position() == 3.0);
  }
  SECTION("processes that fail, fall silent or come back are alerts") {
    const auto sim = [](console::Level level) { return ServiceHealth{"sim", level, "no camera"}; };
    builder.Receive(kBegin, BeliefOf(0, 0.0F));
    builder.Receive(kBegin, sim(console::LEVEL_OK));
    builder.Receive(kBegin + 1.0, sim(console::LEVEL_ERROR));
    builder.Receive(kBegin + 2.0, sim(console::LEVEL_ERROR));
    builder.Receive(kBegin + 3.0, sim(console::LEVEL_OK));
    builder.Receive(kBegin + 9.0, ServiceHealth{"nhpm", console::LEVEL_OK, "fine"});
    const Timeline run = std::move(builder).Finish();
    REQUIRE(KindsOf(run) == std::vector{console::MARK_ALERT, console::MARK_ALERT});
    CHECK_THAT(run.marks[0].text(), Catch::Contains("no camera"));
    CHECK(run.marks[0].position() == 1.0);
    CHECK_THAT(run.marks[1].text(), Catch::Contains("sim"));
    CHECK(run.marks[1].position() == 9.0);
  }
}

TEST_CASE("a run that went quicker than the wall clock is played by its own, also a second one",
          "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  builder.Receive(kBegin, BeliefOf(0, 0.0F));
  for (const auto& [wall_s, stamp_s] :
       {std::pair(2.0, 0), {2.1, 10}, {2.2, 30}, {3.0, 0}, {3.5, 5}}) {  // begins again at 3.0
    builder.Receive(kBegin + wall_s, At(stamp_s, {1, 1}));
  }
  builder.Receive(kBegin + 3.6, BeliefOf(1, 1.0F));
  const Timeline run = std::move(builder).Finish();
  const std::vector<double> expected{0.0, 2.0, 12.0, 32.0, 32.0, 37.0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(run.moments.at(i).position_s == Approx(expected[i]));
  }
  CHECK(run.duration_s == Approx(37.0));
}

TEST_CASE("a link that the attention queue reports lost is an alert", "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  AttentionQueueState queue;
  queue.items = {AttentionItem{.robot = "r1", .reason = AttentionReason::kLinkLost}};
  builder.Receive(kBegin, queue);
  queue.items.clear();  // the notice goes, the robot does not come back
  builder.Receive(kBegin + 60.0, queue);
  const bool reports_again = GENERATE(false, true);
  if (reports_again) {
    builder.Receive(kBegin + 61.0, At(5, {1, 1}));
    builder.Receive(kBegin + 62.0, queue);
  }
  const Timeline run = std::move(builder).Finish();
  std::vector<bool> active;
  for (const Moment& moment : run.moments) {
    if (const auto* alert = std::get_if<Alert>(&moment.value)) active.push_back(alert->active);
  }
  CHECK(active == (reports_again ? std::vector{true, false} : std::vector{true}));
  REQUIRE(run.marks.size() == 1);
  CHECK(run.marks[0].robot() == "r1");
}

TEST_CASE("streamed pictures are no marks, plans and goals are cells of a world that is known",
          "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  builder.Receive(kBegin, samples::SampleSnapshot());
  builder.ReceiveFrame(kBegin, {"r1", {}, {1, 2}});
  const Timeline run = std::move(builder).Finish();
  CHECK(run.marks.empty());
  CHECK(run.moments.size() == 1);
  TimelineBuilder planned(SessionOfOne());
  planned.ReceivePlan(kBegin, "r1", {}, {{0.5, 0.5}});
  planned.ReceiveGoalPose(kBegin, "r1", {0.5, 0.5});
  planned.ReceiveInitialMap(kBegin, "w1", {{}, 2.0, SmallMaze(Occupancy::kFree)});
  planned.Receive(kBegin, At(1, {1, 1}));
  planned.ReceivePlan(kBegin, "r1", {}, {{0.5, 0.5}, {99.0, 0.0}});
  planned.ReceiveGoalPose(kBegin, "r1", {0.5, 0.5});
  planned.ReceiveGoalPose(kBegin, "r1", {99.0, 0.5});
  const Timeline drawn = std::move(planned).Finish();
  REQUIRE(drawn.moments.size() == 4);
  CHECK(std::get<PlannedPath>(drawn.moments[2].value).cells == std::vector<Cell>{{1, 2}});
  CHECK(std::get<GoalSet>(drawn.moments[3].value).cell == Cell{1, 2});
}

}  // namespace
}  // namespace conav::operators
