// How the service decides what pages ask: repeats, worlds that are not known yet, control, bursts.
#include <catch2/catch.hpp>

#include "integration/operator/console_bench.h"
#include "operator/simulated/operator_client.h"
#include "support/packed_grid.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

/// The service with a served world, and a page that has its map.
struct RequestBench : SteppedBench {
  RequestBench() {
    config.method = MethodKind::kTeleop;
    sim.Begin();
    port = Start();
    page.Connect(port);
    page.ReadBelief(0);
  }

  /// What another client of the bus is answered.
  OperatorReply AskAs(const std::string& client, std::uint64_t id,
                      decltype(OperatorRequest::body) body) {
    REQUIRE(requests.Publish(ToMessage(OperatorRequest{{5}, client, id, "w1", std::move(body)})));
    service->Step();
    for (const auto& message : replies.Take()) {
      const auto reply = ToDomain(message);
      if (reply && reply->client == client && reply->request_id == id) return *reply;
    }
    FAIL("no reply to " << client);
    return {};
  }

  bool Takes(const std::string& client, std::uint64_t id) {
    return AskAs(client, id, TakeControlRequest{{}, ""}).accepted;
  }

  /// Who is there, as the page sees it.
  int People() const {
    return page.Has("presence") ? page.at("presence").presence().people_size() : 0;
  }

  bus::Participant other{"other", bus};
  bus::Publisher<conav_msgs::msg::OperatorRequest> requests{other, bus::kOperatorRequest};
  bus::Subscriber<conav_msgs::msg::OperatorReply> replies{other, bus::kOperatorReply};
  bus::Subscriber<conav_msgs::msg::OperatorEvent> events{other, bus::kOperatorEvent};
  bus::Subscriber<conav_msgs::msg::DriveOrder> drives{other, bus::kDriveOrder, "r1"};
  Page page = MakePage('a');
  int port = 0;
};

constexpr const char* kEdit = "edit { cells { cell { row: 1 column: 3 } wall: true } }";
constexpr const char* kDrive = "drive { robot: 'r1' action: DRIVE_FORWARD expires_at: 2 }";
constexpr const char* kStopKey = "drive { robot: 'r1' action: DRIVE_STOP expires_at: 2 }";
constexpr const char* kStop = "stop { robots: 'r1' reason: 'a cat' }";
constexpr const char* kTakeControl = "take_control { robots: 'r1' }";

TEST_CASE("only a participant's page has its layout published", "[operator][integration]") {
  for (const char* kind : {"mapping", ""}) {
    CAPTURE(kind);
    SteppedBench bench;
    bench.config.task.kind = kind;
    bench.config.task.result = (bench.folder / "result.json").string();
    bench.config.task.tags = true;
    bus::Participant recorder("recorder", bench.bus);
    bus::Subscriber<conav_msgs::msg::PageLayout> layouts(recorder, bus::kPageLayout);
    const int port = bench.Start();
    Page page = bench.MakePage('a');
    page.Connect(port);
    page.SendLayout(800.0);
    const bool participates = std::string(kind) == "mapping";
    const auto published = layouts.Take();
    REQUIRE(published.size() == (participates ? 1 : 0));
    if (!participates) continue;
    CHECK(published[0].client() == page.welcome.client());
    CHECK(published[0].width() == 800.0);
    page.ReadUntil([&] { return page.Has("task"); });
    CHECK(page.at("task").task().tags_size() == kPageTags);
  }
}

TEST_CASE("a page edits and guides as every client does", "[operator][integration]") {
  RequestBench bench;
  Page& page = bench.page;
  page.ReadUntil([&] { return page.Has("robot"); });
  CHECK(page.at("robot").robot().cell().column() == 1);
  const auto edited = page.Ask(kEdit);
  CHECK(edited.accepted());
  CHECK(edited.revision() == 1);
  page.ReadBelief(1);
  const auto belief = page.at("belief").belief();
  CHECK(test::UnpackedCells(belief.walls()).at(9) == '\xFF');
  CHECK(test::UnpackedCells(belief.initial_walls()).at(9) == '\0');
  CHECK(belief.edited_by() == page.welcome.client());
  CHECK(bench.sim.NewestBelief().revision == 1);
  CHECK(page.Ask("note { text: 'the door was open' }").accepted());
  const auto events = bench.events.Take();
  REQUIRE(events.size() == 2);
  CHECK(events[0].client() == page.welcome.client());
  CHECK(events[0].cells() == 1);
  CHECK(events[1].text() == "the door was open");
  CHECK(page.Ask("guide { robot: 'r1' valid_for: 60 path { row: 1 column: 1 } path { row: 1 "
                 "column: 2 } }")
            .accepted());
  page.ReadUntil([&] { return page.Has("guidance"); });
  CHECK(page.at("guidance").guidance().given_by() == page.welcome.client());
  CHECK(bench.sim.NewestGuidance().path == std::vector<Cell>{{1, 1}, {1, 2}});
}

TEST_CASE("a repeat of what is stored is answered as before, also before the map has come",
          "[operator][integration]") {
  RequestBench bench;
  REQUIRE(bench.page.Ask(kEdit).accepted());
  bench.bus = std::make_shared<bus::InMemoryBus>();  // on which no simulator is
  const std::string run = bench.page.welcome.run();
  bench.page.Connect(bench.Start());
  CHECK(bench.page.welcome.run() != run);
  const auto again = bench.page.Ask(kEdit, true);
  CHECK(again.accepted());
  CHECK(again.revision() == 1);
}

TEST_CASE("a request about a world that is not known yet waits for its map, as long as it may",
          "[operator][integration]") {
  SteppedBench bench;
  Page page = bench.MakePage('a');
  page.Connect(bench.Start());
  page.Send(kEdit);
  page.Send(kStop);
  CHECK(page.WaitForReply().accepted());  // which came behind it
  bench.sim.PublishInitialMap(kMap);
  CHECK(page.WaitForReply(1).revision() == 1);
  SteppedBench without;
  Page waiting = without.MakePage('a');
  waiting.Connect(without.Start());
  const auto reply = waiting.Ask(kEdit, false, 0.1);
  CHECK_FALSE(reply.accepted());
  CHECK_THAT(reply.reason(), Catch::Contains("w1"));
}

TEST_CASE(
    "a repeat is answered as before although another one has control, and although it is late",
    "[operator][integration]") {
  RequestBench bench;
  REQUIRE(bench.page.Ask(kEdit).accepted());
  REQUIRE(bench.Takes("bert", 1));
  CHECK(bench.page.Ask(kEdit, true).accepted());
  CHECK(bench.page.Ask(kEdit, true, -1000.0).accepted());
  CHECK_THAT(bench.page.Ask(kEdit).reason(), Catch::Contains("bert"));  // a new request
}

TEST_CASE("a request that comes too late is refused and not carried out",
          "[operator][integration]") {
  RequestBench bench;
  const auto late = bench.page.Ask(kEdit, false, -1000.0);
  CHECK_FALSE(late.accepted());
  CHECK_THAT(late.reason(), Catch::Contains("too late"));
  CHECK(bench.sim.NewestBelief().revision == 0);
  // Even a stop: its client has given up, and may have resumed the robot.
  CHECK_FALSE(bench.page.Ask(kStop, false, -1000.0).accepted());
  CHECK_THAT(bench.page.Ask(kEdit, false, 4000.0).reason(), Catch::Contains("3600 s"));
}

TEST_CASE("control lasts while its client asks for something or is there",
          "[operator][integration]") {
  RequestBench bench;
  SECTION("whatever a client asks renews its control") {
    REQUIRE(bench.Takes("anna", 1));
    bench.clock.Advance(40s);
    REQUIRE(bench.AskAs("anna", 2, StopRequest{{"r1"}, "look"}).accepted);
    bench.clock.Advance(40s);
    CHECK_FALSE(bench.Takes("bert", 1));
    bench.clock.Advance(21s);
    CHECK(bench.Takes("bert", 2));
  }
  SECTION("a page that is used keeps its control without asking for anything") {
    REQUIRE(bench.page.Ask(kTakeControl).accepted());
    bench.clock.Advance(40s);
    bench.page.Use();
    bench.service->Step();
    bench.clock.Advance(40s);
    CHECK_FALSE(bench.Takes("bert", 1));
    bench.clock.Advance(21s);
    CHECK(bench.Takes("bert", 2));
  }
  SECTION("control of a page that left is free after ten seconds") {
    Page leaving = bench.MakePage('b');
    leaving.Connect(bench.port);
    REQUIRE(leaving.Ask(kTakeControl).accepted());
    bench.page.ReadUntil([&] { return bench.People() == 2; });
    leaving.Disconnect();
    bench.page.ReadUntil([&] { return bench.People() == 1; });
    bench.clock.Advance(9s);
    CHECK_FALSE(bench.Takes("bert", 1));
    bench.clock.Advance(1s);
    bench.service->Step();
    CHECK(bench.Takes("bert", 2));
  }
}

TEST_CASE("a stopped robot stays stopped over a restart, the page names operator and reason",
          "[operator][integration]") {
  RequestBench bench;
  REQUIRE(bench.page.Ask(kStop).accepted());
  bench.page.Connect(bench.Start());
  bench.page.ReadUntil([&] { return bench.page.Has("control"); });
  const auto control = bench.page.at("control").control();
  CHECK(control.stopped());
  CHECK(control.stopped_by() == bench.page.welcome.client());
  CHECK(control.stop_reason() == "a cat");
  CHECK_THAT(bench.page.Ask(kDrive).reason(), Catch::Contains("stopped"));
  bus::Subscriber<conav_msgs::msg::StopOrder> late(bench.other, bus::kStopOrder, "r1");
  const auto stops = late.Take();
  REQUIRE(stops.size() == 1);
  CHECK(stops[0].stopped());
}

TEST_CASE("the command log has a refused request once", "[operator][integration]") {
  RequestBench bench;
  REQUIRE(bench.Takes("bert", 1));
  const EditRequest edit{0, {{{1, 3}, true}}};
  for (int i = 0; i < 3; ++i) CHECK_FALSE(bench.AskAs("anna", 1, edit).accepted);
  bench.AskAs("carl", 1, StopRequest{{"r1"}, "done"});
  const auto& events = bench.page.events();
  bench.page.ReadUntil([&] { return !events.empty() && events.back().client() == "carl"; });
  REQUIRE(events.size() == 3);
  CHECK(events[0].kind() == console::EVENT_TAKE_CONTROL);
  CHECK(events[1].kind() == console::EVENT_REFUSED);
  CHECK(events[1].client() == "anna");
}

TEST_CASE("of a burst of low-level actions of a page only the newest is carried out",
          "[operator][integration]") {
  RequestBench bench;
  for (int i = 0; i < 3; ++i) bench.page.Send(kDrive);
  bench.page.Send(kStopKey);
  const auto received = [&] {  // which the gateway counts on a thread of its own
    return MetricOf(bench.port, "conav_console_received_messages_total").value();
  };
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (received() < 5) REQUIRE(std::chrono::steady_clock::now() < deadline);  // with the Hello
  CHECK(bench.page.WaitForReply(4).accepted());
  for (std::uint64_t id = 1; id < 4; ++id) {
    const auto reply = bench.page.WaitForReply(id);
    CHECK_FALSE(reply.accepted());
    CHECK_THAT(reply.reason(), Catch::Contains("request 4"));
  }
  CHECK(bench.drives.Take().size() == 1);
}

/// A form without robots, and the pages of participant and experimenter.
struct StudyBench : SteppedBench {
  StudyBench() {
    config.robots = {};
    config.task.kind = "form";
    config.task.step = "mood";
    config.task.participant = "P07";
    config.task.result = (folder / "result.json").string();
    config.task.form = (folder / "mood.json").string();
    config.task.experimenter = true;
    config.task.completion_code = "C-123";
    std::ofstream(config.task.form) << R"({"elements": [{"name": "age"}]})";
    port = Start();
    page.Connect(port);
    lead.Connect(port, "", true);
  }
  /// As it begins until it is received.
  static const console::Task& TaskOf(const Page& of) {
    return of.Has("task") ? of.at("task").task() : console::Task::default_instance();
  }

  Page page = MakePage('a');
  Page lead = MakePage('b');
  int port = 0;
};

TEST_CASE("an experimenter leads a step that a participant goes through",
          "[operator][integration]") {
  StudyBench bench;
  CHECK(bench.lead.welcome.role() == console::ROLE_EXPERIMENTER);
  CHECK(bench.page.welcome.mode() == console::MODE_STUDY);
  CHECK_FALSE(bench.page.Ask("pause { on: true }").accepted());
  CHECK_FALSE(bench.lead.Ask("answers { json: '{}' }").accepted());
  // Sent for the step before, whose reply was lost.
  CHECK_FALSE(bench.page.Ask("answers { json: '{\"age\": 5}' step: 'sus' }").accepted());
  CHECK(bench.page.Ask("draft { json: '{\"age\": 4}' step: 'mood' }").accepted());
  bench.lead.ReadUntil([&] { return bench.lead.Has("draft"); });

  CHECK(bench.lead.Ask("pause { on: true }").accepted());
  bench.page.ReadUntil([&] { return bench.TaskOf(bench.page).paused(); });
  CHECK_FALSE(bench.page.Ask("answers { json: '{}' }").accepted());
  CHECK(bench.lead.Ask("note { text: 'looks tired' }").accepted());
  bench.lead.ReadUntil([&] {
    return bench.lead.Has("study_log") &&
           bench.lead.at("study_log").study_log().entries_size() == 3;
  });
  CHECK(bench.lead.Ask("pause {}").accepted());
  CHECK(bench.TaskOf(bench.page).completion_code().empty());
  CHECK(bench.page.Ask("answers { json: '{\"age\": 41}' }").accepted());
  bench.page.ReadUntil([&] { return !bench.TaskOf(bench.page).completion_code().empty(); });
  CHECK_FALSE(bench.page.Has("study_log"));  // notes are about the participant
  CHECK(bench.page.events().empty());
}

}  // namespace
}  // namespace conav::operators
