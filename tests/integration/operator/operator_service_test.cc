#include "operator/operator_service.h"

#include "common/service/diagnostics.h"
#include "common/service/robot_state_topics.h"
#include "integration/operator/operator_bench.h"
#include "support/full_disk.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kUnsureMap = {"######", "#  ? #", "# ## #", "#    #", "######"};

OperatorConfig ConfigIn(const TemporaryFolder& folder) { return ConfigFor(folder / "operator.db"); }

/// A service before, in whose world r1 was guided after so many pictures.
void GuideBefore(const TemporaryFolder& folder, std::uint64_t snapshots = 0) {
  OperatorBench bench(ConfigIn(folder));
  bench.sim.PublishInitialMap(kUnsureMap);
  bench.sim.PublishState({1, 1}, 5, snapshots);
  REQUIRE(bench.Ask(GuideRequest{"r1", {{1, 1}}, snapshots, 1.0}).accepted);
}

/// kUnsureMap with another wall.
std::vector<std::string> AnotherMap() {
  std::vector<std::string> map = kUnsureMap;
  map[1][1] = '#';
  return map;
}

TEST_CASE("The initial map becomes revision 0, unknown cells at even odds",
          "[operator][integration]") {
  OperatorBench bench;
  bench.service.Step();
  CHECK(bench.sim.belief.Take().empty());
  bench.sim.PublishInitialMap(kUnsureMap);
  bench.service.Step();
  CHECK(bench.sim.NewestBelief() == Belief{{0}, "w1", 0, DrawnMap(kUnsureMap), "", 1.5});
  const auto maps = bench.sim.belief_map.Take();
  REQUIRE(maps.size() == 1);
  CHECK(maps[0].info().resolution() == 1.5F);
  CHECK(maps[0].info().width() == 6);
}

TEST_CASE("An accepted edit and guidance are published, with the world's time",
          "[operator][integration]") {
  OperatorBench bench;
  bench.sim.PublishInitialMap(kUnsureMap);
  bench.sim.PublishState({1, 1}, 5'000'000'000);
  const auto edit = bench.client.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  CHECK(bench.Settle(edit) == OperatorReply{"anna", 1, true, "", 1});
  const Belief belief = bench.sim.NewestBelief();
  CHECK(belief.revision == 1);
  CHECK(belief.stamp == SimTime{5'000'000'000});
  CHECK(belief.edited_by == "anna");
  CHECK(belief.wall_probability[{1, 3}] == 1.0F);

  const auto guide = bench.client.Send("w1", GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 60.0}, {});
  CHECK(bench.Settle(guide).accepted);
  CHECK(bench.sim.NewestGuidance() ==
        Guidance{{5'000'000'000}, "w1", "r1", 1, {{1, 1}, {1, 2}}, "anna", 1, 0, {65'000'000'000}});
}

TEST_CASE("An edit of thousands of cells, and a path over a large raster, are one request each",
          "[operator][integration]") {
  const int side = GENERATE(150, 1000);
  OperatorBench bench;
  const OccupancyGrid water(side, side, Occupancy::kFree);
  bench.sim.grid = {side, side, 1.0};
  REQUIRE(bench.sim.initial_map.Publish(ToMessage(MapUpdate{{0}, 1.0, water})));
  bench.sim.PublishState({1, 1}, 5);
  bench.service.Step();
  EditRequest edit{0, {}};
  for (int i = 0; i < 4000; ++i) edit.edits.push_back({{40 + i / 80, 40 + i % 80}, true});
  CHECK(bench.Ask(edit) == OperatorReply{"anna", 1, true, "", 1});
  const Belief belief = bench.sim.NewestBelief();
  CHECK(belief.wall_probability[{40, 40}] == 1.0F);
  CHECK(std::ranges::count(belief.wall_probability.values(), 1.0F) == 4000);
  std::vector<Cell> path;
  for (int column = 1; column < side - 1; ++column) path.push_back({1, column});
  CHECK(bench.Ask(GuideRequest{"r1", path, 0, 60.0}).accepted);
  CHECK(bench.sim.NewestGuidance().path == path);
}

TEST_CASE("Guidance for a robot that never reported, or of another world, is refused",
          "[operator][integration]") {
  OperatorBench bench;
  bench.sim.PublishInitialMap(kUnsureMap);
  CHECK_FALSE(bench.Ask(GuideRequest{"r1", {}, 0, 1.0}).accepted);
  bench.sim.PublishState({1, 1}, 5, 0, "w2");
  CHECK_FALSE(bench.Ask(GuideRequest{"r1", {}, 0, 1.0}).accepted);
  bench.sim.PublishState({1, 1}, 6);
  CHECK(bench.Ask(GuideRequest{"r1", {}, 0, 1.0}).accepted);
}

TEST_CASE("A service that starts again publishes what it knew once the initial map is the same",
          "[operator][integration]") {
  const TemporaryFolder folder;
  {
    OperatorBench bench(ConfigIn(folder));
    bench.sim.Begin(kUnsureMap);
    bench.Ask(EditRequest{0, {{{1, 3}, true}}});
    bench.Ask(GuideRequest{"r1", {{1, 1}}, 0, 1.0});
  }
  OperatorBench again(ConfigIn(folder));
  OperatorClient bert(again.client_participant, again.clock, {"bert", 0.25, 10.0});
  bert.Send("w1", EditRequest{1, {{{1, 1}, true}}}, {});
  again.service.Step();
  CHECK(again.sim.belief.Take().empty());
  CHECK(again.sim.guidance.Take().empty());
  CHECK(bert.Poll().empty());
  again.sim.PublishInitialMap(kUnsureMap);  // does not undo the edit
  again.service.Step();
  CHECK(again.sim.NewestBelief().revision == 1);
  CHECK(again.sim.NewestGuidance().revision == 1);
  again.clock.Advance(250ms);
  CHECK(bert.Poll().empty());  // asks again
  again.service.Step();
  const auto outcomes = bert.Poll();
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].reply->revision == 2);
}

TEST_CASE("A database of another world is refused by name and nothing of it is published",
          "[operator][integration]") {
  const TemporaryFolder folder;
  GuideBefore(folder);
  OperatorBench other(ConfigIn(folder));
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health(other.client_participant,
                                                                bus::kDiagnostics);
  other.sim.PublishInitialMap(AnotherMap());
  other.sim.PublishState({1, 2}, 5);
  other.clock.Advance(1s);
  OperatorClient bert(other.client_participant, other.clock, {"bert", 0.25, 10.0});
  bert.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  other.service.Step();
  const auto outcomes = bert.Poll();
  REQUIRE(outcomes.size() == 1);
  const OperatorReply& reply = *outcomes[0].reply;
  CHECK_FALSE(reply.accepted);
  CHECK_THAT(reply.reason,
             Catch::Contains((folder / "operator.db").string()) && Catch::Contains("w1"));
  const auto reports = health.Take();
  REQUIRE(reports.size() == 1);
  CHECK(reports[0].status().at(0).level() == 2);
  CHECK(reports[0].status().at(0).message() == reply.reason);
  CHECK(other.sim.belief.Take().empty());
  CHECK(other.sim.belief_map.Take().empty());
  CHECK(other.sim.guidance.Take().empty());

  other.sim.PublishInitialMap(kUnsureMap);  // the right world after all
  other.service.Step();
  CHECK(other.sim.NewestBelief().revision == 0);
  other.sim.PublishInitialMap(AnotherMap());
  other.service.Step();
  bus::Subscriber<conav_msgs::msg::BeliefMap> late(other.client_participant, bus::kBelief, "w1");
  CHECK(late.Take().empty());
}

TEST_CASE("A refused database stays as it is", "[operator][integration]") {
  const TemporaryFolder folder;
  GuideBefore(folder, 3);
  {
    OperatorBench other(ConfigIn(folder));
    other.sim.PublishInitialMap(AnotherMap());
    other.sim.PublishState({1, 2}, 5, 0);  // fewer pictures than the guidance answers
    other.service.Step();
  }
  OperatorBench again(ConfigIn(folder));
  again.sim.PublishInitialMap(kUnsureMap);
  again.sim.PublishState({1, 1}, 5, 3);
  again.service.Step();
  const auto guidance = again.sim.guidance.Take();
  REQUIRE(guidance.size() == 1);
  CHECK(guidance[0].revision() == 1);
  CHECK(guidance[0].path().size() == 1);
}

TEST_CASE("Stored guidance is withdrawn from a robot that restarts its count of pictures",
          "[operator][integration]") {
  const TemporaryFolder folder;
  GuideBefore(folder, 3);
  OperatorBench again(ConfigIn(folder));
  again.sim.PublishInitialMap(kUnsureMap);
  again.service.Step();
  CHECK(again.sim.NewestGuidance().answers_snapshot == 3);
  again.sim.PublishState({1, 1}, 1, 0);
  again.service.Step();
  const Guidance withdrawn = again.sim.NewestGuidance();
  CHECK(withdrawn.path.empty());
  CHECK(withdrawn.revision == 2);
  CHECK(withdrawn.answers_snapshot == 0);
}

TEST_CASE("A request is repeated until its reply and carried out once", "[operator][integration]") {
  OperatorBench bench;
  bench.sim.PublishInitialMap(kUnsureMap);
  const auto id = bench.client.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  for (int i = 0; i < 4; ++i) {
    bench.clock.Advance(250ms);
    CHECK(bench.client.Poll().empty());
  }
  CHECK(bench.Settle(id).revision == 1);  // five copies were waiting
  CHECK(bench.sim.NewestBelief().revision == 1);
  CHECK(bench.client.pending() == 0);
  CHECK(bench.client.Poll().empty());
}

// The faults report's S7: "An OperatorRequest over DDS has no time until which it counts. A Go asked
// during a cut was carried out 1.24 s after the heal, about 5 s late."
TEST_CASE("A request that was under way for too long is void, its repeat is carried out",
          "[operator][integration]") {
  OperatorBench bench;
  bench.sim.Begin();
  REQUIRE(bench.Ask(StopRequest{}).accepted);
  bench.bus->SetSourceDelay(4s);
  const auto go = bench.client.Send("w1", ResumeRequest{}, {});
  bench.service.Step();
  CHECK(bench.client.Poll().empty());  // no reply: it would also be one to the repeat
  bench.bus->SetSourceDelay(0s);
  bench.clock.Advance(250ms);
  CHECK(bench.client.Poll().empty());
  CHECK(bench.Settle(go).accepted);
}

TEST_CASE("The first request of a client is void, too, once its process has answered for its clock",
          "[operator][integration]") {
  OperatorBench bench;
  bench.sim.Begin();
  Diagnostics diagnostics(bench.client_participant, bench.clock);
  for (int i = 0; i < 4; ++i) {
    bench.service.Step();
    diagnostics.Tick([] { return Health{}; });
    bench.clock.Advance(500ms);
  }
  bench.bus->SetSourceDelay(15s);  // the clock of this test runs at another pace than the wall's
  bench.client.Send("w1", ResumeRequest{}, {});
  bench.service.Step();
  CHECK(bench.client.Poll().empty());
}

// The faults report's S6: "A forged RobotState with a stamp 2e9 s ahead: robot shown elsewhere, every
// page thrown out. Stamps are not bounded against the past ones."
TEST_CASE("A state whose stamp is far ahead does not count unless it says the truth",
          "[operator][integration]") {
  OperatorBench bench;
  RobotStateTopics states(bench.client_participant, "r1");
  const auto taken = [&](std::int64_t stamp_s) {
    bench.sim.PublishState({1, 1}, stamp_s * 1'000'000'000);
    return states.TakeStamped().size() == 1;
  };
  CHECK(taken(1'700'000'000));  // the first: a robot of the field
  CHECK(taken(5));              // a simulation that begins
  CHECK_FALSE(taken(2'000'000'000));
  CHECK(taken(3605));
  CHECK_FALSE(taken(7206));
  bench.bus->SetSourceDelay(-4s);
  CHECK(taken(7206));  // 4 s later, and no other robot has spoken
}

TEST_CASE("Without a service the client gives up at its deadline", "[operator][integration]") {
  const auto bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("client", bus);
  FakeClock clock;
  OperatorClient client(participant, clock, {"anna", 0.25, 2.0});
  const auto id = client.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  clock.Advance(1999ms);
  CHECK(client.Poll().empty());
  clock.Advance(1ms);
  const auto outcomes = client.Poll();
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].request_id == id);
  REQUIRE_FALSE(outcomes[0].reply.has_value());
  CHECK(outcomes[0].reply.error().code == ErrorCode::kTimeout);
  CHECK(client.pending() == 0);
}

TEST_CASE("Replies to other clients are not taken", "[operator][integration]") {
  OperatorBench bench;
  OperatorClient other(bench.client_participant, bench.clock, {"bert", 0.25, 2.0});
  bench.sim.PublishInitialMap(kUnsureMap);
  const auto mine = bench.client.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  const auto his = other.Send("w1", EditRequest{0, {{{1, 1}, true}}}, {});
  REQUIRE(mine == his);
  CHECK(bench.Settle(mine).accepted);
  const auto outcomes = other.Poll();
  REQUIRE(outcomes.size() == 1);
  CHECK_FALSE(outcomes[0].reply->accepted);  // it came second, on an old revision
}

// The faults report's S4: a rogue under a client's name went around its control and used up its request ids,
// so that its own STOP was refused.
TEST_CASE("A program that asks under another one's name is ignored", "[operator][integration]") {
  OperatorBench bench;
  bench.sim.PublishInitialMap(kUnsureMap);
  bench.sim.PublishState({1, 1}, 5);
  const auto control = bench.client.Send("w1", TakeControlRequest{{"r1"}, ""}, {});
  REQUIRE(bench.Settle(control).accepted);
  bus::Participant rogue("rogue", bench.bus);
  bus::Publisher<conav_msgs::msg::OperatorRequest> requests(rogue, bus::kOperatorRequest);
  bus::Subscriber<conav_msgs::msg::OperatorReply> replies(rogue, bus::kOperatorReply);
  const OperatorRequest forged{{}, "anna", control + 1, "w1", GuideRequest{"r1", {{1, 1}}, 0, 1.0}};
  REQUIRE(requests.Publish(ToMessage(forged)));
  bench.service.Step();
  CHECK(replies.Take().empty());
  const OperatorReply reply = bench.Ask(StopRequest{{"r1"}, ""});
  CHECK(reply.request_id == control + 1);
  CHECK(reply.accepted);
}

TEST_CASE("Of keys that piled up the newest is passed on to the planner, and nothing stored",
          "[operator][integration]") {
  OperatorBench bench;
  bus::Subscriber<conav_msgs::msg::DriveOrder> orders(bench.client_participant, bus::kDriveOrder,
                                                      "r1");
  bench.sim.PublishInitialMap(kUnsureMap);
  bench.sim.PublishState({1, 1}, 1'000'000'000);
  bench.service.Step();
  const DriveRequest key{"r1", DriveAction::kTurnLeft, SimTime::FromSeconds(2.0)};
  std::uint64_t newest = 0;
  for (int i = 0; i < 8; ++i) newest = bench.client.Send("w1", key, {});
  bench.service.Step();
  const auto outcomes = bench.client.Poll();
  CHECK(outcomes.size() == 8);
  for (const auto& outcome : outcomes) {
    CHECK(outcome.reply.value().accepted == (outcome.request_id == newest));
  }
  CHECK(orders.TakeValid([](const auto& message) { return ToDomain(message); }) ==
        std::vector<DriveOrder>{{SimTime::FromSeconds(1.0), "w1", "r1", 1, DriveAction::kTurnLeft,
                                 "anna", SimTime::FromSeconds(2.0)}});
  CHECK(bench.sim.NewestBelief().revision == 0);
  CHECK(bench.sim.guidance.Take().empty());
}

TEST_CASE("Health names missing maps and a disk that fails", "[operator][integration]") {
  OperatorBench bench;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health(bench.client_participant,
                                                                bus::kDiagnostics);
  const auto newest = [&] {
    bench.clock.Advance(1s);
    bench.service.Step();
    const auto reports = health.Take();
    REQUIRE(reports.size() == 1);
    return reports[0].status().at(0);
  };
  CHECK(newest().level() == 1);
  CHECK(newest().message().find("w1") != std::string::npos);
  bench.sim.PublishInitialMap(kUnsureMap);
  CHECK(newest().level() == 0);
  const auto edit = [&](std::uint64_t base) {
    return bench.Ask(EditRequest{base, {{{1, 3}, true}}});
  };
  {
    const test::FullDisk full(4096);
    const OperatorReply refused = edit(0);
    CHECK_FALSE(refused.accepted);
    CHECK_THAT(refused.reason, Catch::Contains("not stored"));
    CHECK(newest().level() == 2);
    // Asks nothing of the disk, and says nothing about it.
    CHECK_FALSE(bench.Ask(SelectRequest{"r1", AttentionReason::kSnapshot}).accepted);
    CHECK_FALSE(bench.Ask(AcknowledgeRequest{99}).accepted);
    const auto failed = newest();
    CHECK(failed.level() == 2);
    CHECK_THAT(failed.message(), Catch::Contains("operator.db"));
  }
  CHECK(newest().level() == 2);  // nobody knows yet
  CHECK(edit(0).accepted);
  CHECK(newest().level() == 0);
  const test::FullDisk full(4096);
  CHECK_FALSE(edit(7).accepted);  // not even the refusal can be stored
  CHECK_THAT(newest().message(), Catch::Contains("operator.db"));
}

}  // namespace
}  // namespace conav::operators
