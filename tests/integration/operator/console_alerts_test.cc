// Alerts and ages, as pages see them.
#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/bus/ros_graph.h"
#include "common/service/diagnostics.h"
#include "integration/operator/console_bench.h"
#include "support/full_disk.h"
#include "unit/common/msg/samples.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

struct AlertBench : SteppedBench {
  AlertBench() {
    sim.Begin();
    page.Connect(Start());
    page.ReadBelief(0);
  }

  /// The alert about the lost robot, once `is` holds for it.
  template <class Condition>
  console::Alert ReadAlert(const Condition& is) {
    const console::Alert* found = nullptr;
    page.ReadUntil([&] {
      for (const auto& [id, alert] : page.alerts()) {
        if (alert.source() == "r1" && is(alert)) found = &alert;
      }
      return found != nullptr;
    });
    return *found;
  }
  console::Alert ReadAlert(bool active) {
    return ReadAlert([&](const console::Alert& alert) { return alert.active() == active; });
  }
  void LookAround() {
    clock.Advance(250ms);
    service->Step();
  }

  Page page = Page('a', [this] {
    clock.Advance(50ms);
    service->Step();
  });
};

std::string Acknowledge(std::uint64_t alert) {
  return fmt::format("acknowledge {{ alert: {} }}", alert);
}
std::string Shelve(std::uint64_t alert) {
  return fmt::format("shelve {{ alert: {} duration: 600 }}", alert);
}

TEST_CASE("that a robot is lost is an alarm as long as it is, whatever the queue shows",
          "[operator][integration]") {
  AlertBench bench;
  const bool has_goals = GENERATE(true, false);
  CAPTURE(has_goals);
  if (!has_goals) {
    bench.sim.goals_left.clear();
    bench.sim.PublishState({1, 1}, 6);
    bench.service->Step();
  }
  bench.sim.LoseRobot();
  const console::Alert lost = bench.ReadAlert(true);
  CHECK(lost.severity() == console::SEVERITY_ALARM);
  const auto selected = bench.page.Ask("select { robot: 'r1' reason: REASON_LINK_LOST }");
  CHECK(selected.accepted() == has_goals);  // after which the notice leaves the queue
  bench.LookAround();
  CHECK(bench.page.Ask(Shelve(lost.id())).accepted());
  const auto shelved = bench.ReadAlert([](const auto& alert) { return alert.shelved_until() > 0; });
  CHECK(shelved.active());
  CHECK(shelved.count() == 1);

  bench.sim.FindRobot();
  bench.sim.PublishState({1, 1}, 7);
  CHECK(bench.ReadAlert(false).id() == lost.id());
}

TEST_CASE("acknowledged and shelved alerts stay so after a restart, while they last",
          "[operator][integration]") {
  AlertBench bench;
  CHECK_THAT(bench.page.Ask(Acknowledge(9)).reason(), Catch::Contains("9"));
  bench.sim.LoseRobot();
  const std::uint64_t id = bench.ReadAlert(true).id();
  REQUIRE(bench.page.Ask(Acknowledge(id)).accepted());
  REQUIRE(bench.page.Ask(Shelve(id)).accepted());
  const auto is_shelved = [](const auto& alert) { return alert.shelved_until() > 0; };
  const console::Alert before = bench.ReadAlert(is_shelved);
  CHECK(before.acknowledged_by() == bench.page.welcome.client());

  bench.page.Connect(bench.Start());
  CHECK(bench.ReadAlert(is_shelved).SerializeAsString() == before.SerializeAsString());
}

TEST_CASE("the operator service says on the page that it has restarted, and what it still knows",
          "[operator][integration]") {
  AlertBench bench;
  const auto restart = [&] {
    return std::ranges::find_if(bench.page.alerts(), [](const auto& entry) {
      return entry.second.text().find("operator has restarted") != std::string::npos;
    });
  };
  REQUIRE(bench.page.Ask("edit { cells { cell { row: 1 column: 3 } wall: true } }").accepted());
  bench.LookAround();
  CHECK(restart() == bench.page.alerts().end());
  bench.page.Connect(bench.Start());
  bench.page.ReadUntil([&] { return restart() != bench.page.alerts().end(); });
  CHECK_THAT(restart()->second.text(), Catch::Contains("requests answered before: 1"));
  CHECK(restart()->second.active());
}

TEST_CASE("the silence of a process is noticed within 2 s, of a robot within 3 s",
          "[operator][integration]") {
  SteppedBench bench;
  Page page = bench.MakePage('a');
  page.Connect(bench.Start());
  Diagnostics diagnostics(bench.sim.participant, bench.clock);
  bench.sim.Begin();
  diagnostics.Tick([] { return Health{}; });
  page.ReadUntil([&] { return page.Has("robot"); });
  const auto count = [&](const std::string& source) {
    return std::ranges::count_if(page.alerts(), [&](const auto& entry) {
      return entry.second.source() == source && entry.second.active();
    });
  };
  const auto later = [&](std::chrono::milliseconds by) {
    bench.clock.Advance(by);
    bench.service->Step();
    REQUIRE(page.Ask("note { text: 'now' }").accepted());  // after all updates so far
  };
  const std::string process = bench.sim.participant.node_name();
  later(1400ms);
  CHECK(count(process) == 0);
  later(500ms);
  page.ReadUntil([&] { return count(process) == 1; });
  later(500ms);
  CHECK(count("r1") == 0);
  later(500ms);
  page.ReadUntil([&] { return count("r1") == 1; });
}

// The faults report's S11: "Forged /diagnostics make rows without bound: 2473 processes and 4232 alerts
// from 3000 messages, stored and sent to each page; real alarms drown."
TEST_CASE("of 3000 processes that report some are left out, an alert says so, alarms still come",
          "[operator][integration]") {
  AlertBench bench;
  bus::Participant forger("forger", bench.bus);
  bus::Publisher<diagnostic_msgs::msg::DiagnosticArray> diagnostics(forger, bus::kDiagnostics);
  for (int i = 0; i < 3000; ++i) {
    diagnostic_msgs::msg::DiagnosticStatus status;
    status.hardware_id(fmt::format("forged-{}", i));
    status.level(2);
    status.message(std::string(10'000, 'x'));
    diagnostic_msgs::msg::DiagnosticArray array;
    array.status({status});
    REQUIRE(diagnostics.Publish(array));
    if (i % 100 == 0) bench.LookAround();
  }
  const auto has_alert_of = [&](const char* source) {
    return std::ranges::any_of(bench.page.alerts(), [&](const auto& entry) {
      return entry.second.source() == source && entry.second.active();
    });
  };
  bench.page.ReadUntil([&] { return has_alert_of("diagnostics"); });
  bench.sim.LoseRobot();
  bench.page.ReadUntil([&] { return has_alert_of("r1"); });
  // At most one that each is ill, and one that it is silent.
  CHECK(bench.page.alerts().size() <= 2 * ServiceMonitor::kMostProcesses + 2);
  for (const auto& [id, alert] : bench.page.alerts()) CHECK(alert.text().size() < 1000);
}

// G12 of the faults report's goals: "run continues, alert raised".
TEST_CASE(
    "on a full disk edits are refused with an alarm, robots are still shown and can be stopped",
    "[operator][integration]") {
  AlertBench bench;
  const std::string edit = "edit { cells { cell { row: 1 column: 3 } wall: true } }";
  const auto alarm_is = [&](bool active) {
    return std::ranges::any_of(bench.page.alerts(), [&](const auto& entry) {
      return entry.second.source() == "operator" && entry.second.active() == active;
    });
  };
  bus::Participant robot("robot", bench.bus);
  bus::Subscriber<conav_msgs::msg::StopOrder> robot_stops(robot, bus::kStopOrder, "r1");
  {
    const test::FullDisk full(4096);
    CHECK_THAT(bench.page.Ask(edit).reason(), Catch::Contains("operator.db"));
    CHECK(bench.page.Ask("stop { }").accepted());
    const auto stops = robot_stops.Take();
    REQUIRE(stops.size() == 1);
    CHECK(stops[0].stopped());
    CHECK_THAT(bench.page.Ask("resume { }").reason(), Catch::Contains("operator.db"));
    bench.page.ReadUntil([&] { return alarm_is(true); });
    bench.sim.PublishState({1, 1}, 6'000'000'000);
    bench.page.ReadUntil([&] { return bench.page.at("robot").robot().stamp() == 6.0; });
  }
  CHECK(bench.page.Ask(edit).accepted());
  bench.page.ReadUntil([&] { return alarm_is(false); });
  bench.clock.Advance(1s);
  bench.service->Step();  // stores the stop
  bench.page.Connect(bench.Start());
  bench.page.ReadUntil(
      [&] { return bench.page.Has("control") && bench.page.at("control").control().stopped(); });
}

TEST_CASE("old states and pictures are old for a service that starts later",
          "[operator][integration]") {
  SteppedBench bench;
  bench.bus->SetSourceDelay(1h);
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5'000'000'000);
  Snapshot snapshot = samples::SampleSnapshot();
  snapshot.streamed = false;
  REQUIRE(bench.sim.snapshot.Publish(ToMessage(snapshot)));
  bench.bus->SetSourceDelay(0s);
  Page page = bench.MakePage('a');
  const int port = bench.Start();
  page.Connect(port);
  page.ReadUntil([&] { return page.Has("robot") && page.Has("snapshot"); });
  CHECK(page.at("snapshot").snapshot().bytes() == 3);
  CHECK(Get(port, "/pictures/r1/9.jpg").body == "\xFF\xD8\xFF");
  CHECK(Get(port, "/readyz").status == 200);
  const double now_s = page.welcome.service_time();
  CHECK(page.at("robot").robot().received_at() < now_s - 3500.0);
  CHECK(page.at("snapshot").snapshot().received_at() < now_s - 3500.0);
  bench.sim.PublishState({1, 1}, 6'000'000'000);
  page.ReadUntil([&] { return page.at("robot").robot().stamp() == 6.0; });
  CHECK(page.at("robot").robot().received_at() > now_s - 60.0);
}

TEST_CASE("nothing arrives before it was published, whatever another host's clock says",
          "[operator][integration]") {
  SteppedBench bench;
  bench.bus->SetSourceDelay(-1h);
  bench.sim.Begin();
  Page page = bench.MakePage('a');
  page.Connect(bench.Start());
  page.ReadUntil([&] { return page.Has("robot"); });
  CHECK(page.at("robot").robot().received_at() < page.welcome.service_time() + 60.0);
}

TEST_CASE("Over a link search reports come for the robots of which a page shows them",
          "[operator][integration]") {
  SteppedBench bench;
  bench.bus->SetOverLink();
  bench.sim.Begin();
  bus::Publisher<conav_msgs::msg::SearchReport> search(bench.sim.participant, bus::kSearchReport,
                                                       "r1");
  Page page = bench.MakePage('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  CHECK(search.matched_subscribers() == 0);
  SearchReport report = samples::SampleReport();
  report.robot = "r1";
  REQUIRE(search.Publish(ToMessage(report)));  // before the page shows it
  page.ShowSearches("r1");
  page.ReadUntil([&] { return page.Has("search"); });
  CHECK(search.matched_subscribers() == 1);
  page.ShowSearches("");
  page.Use();
  bench.service->Step();
  CHECK(search.matched_subscribers() == 0);
}

// The faults report's (d): "sim 0.5 s behind shows age 0.66 s for good, 2 s behind 2.1 s = \"stale\" for
// good; ahead (0.5 s, 1 h) looks fresh".
TEST_CASE("ages are right although a robot's clock is wrong, which an alert names",
          "[operator][integration]") {
  const auto ahead = GENERATE(-5000ms, 5000ms, 3'600'000ms);
  SteppedBench bench;
  Diagnostics diagnostics(bench.sim.participant, bench.clock,
                          [ahead] { return std::chrono::system_clock::now() + ahead; });
  bench.bus->SetSourceDelay(-ahead);
  bench.sim.Begin();
  Page page = bench.MakePage('a');
  page.Connect(bench.Start());
  diagnostics.Tick([] { return Health{}; });
  bench.clock.Advance(1s);  // as no other clock does: one second of the offset
  page.ReadUntil([&] { return !page.alerts().empty(); });
  const console::Alert& alert = page.alerts().begin()->second;
  CHECK(alert.source() == bus::HostName());
  CHECK_THAT(alert.text(), Catch::Contains(ahead > 0ms ? "ahead" : "behind"));
  std::int64_t stamp_s = 6;
  for (const auto old : {30s, 0s}) {  // how long ago the robot sent it
    bench.bus->SetSourceDelay(old - ahead);
    bench.sim.PublishState({1, 1}, ++stamp_s * 1'000'000'000);
    page.ReadUntil(
        [&] { return page.at("robot").robot().stamp() == static_cast<double>(stamp_s); });
    CHECK(page.at("robot").robot().received_at() ==
          Approx(WallSeconds() - static_cast<double>(old.count())).margin(10.0));
  }
}

}  // namespace
}  // namespace conav::operators
