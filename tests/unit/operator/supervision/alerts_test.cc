#include "operator/supervision/alerts.h"

#include <algorithm>
#include <catch2/catch.hpp>

namespace conav::operators {
namespace {

Condition Link(const std::string& robot) {
  return {"link/" + robot, Severity::kAlarm, robot, "no message of " + robot, "look"};
}

Findings Lost(const std::string& robot) { return {{Link(robot)}, {}}; }
Findings Back(const std::string& robot) { return {{}, {"link/" + robot}}; }

using Keys = std::vector<std::string>;

TEST_CASE("A condition raises one alert, which is counted when it comes and goes",
          "[operator][alerts]") {
  AlertRegistry registry;
  const auto raised = registry.Update(Lost("r1"), 100.0).changed;
  REQUIRE(raised.size() == 1);
  CHECK(raised[0] == Alert{.id = 1, .condition = Link("r1"), .raised_s = 100.0, .newest_s = 100.0});
  CHECK(registry.Update(Lost("r1"), 101.0).changed.empty());
  CHECK(registry.alerts().size() == 1);
  registry.Update(Lost("r1"), 100.0);
  REQUIRE(registry.Update(Back("r1"), 101.0).changed.size() == 1);
  CHECK_FALSE(registry.alerts().at(1).active);
  registry.Update(Lost("r1"), 102.0);
  const Alert& alert = registry.alerts().at(1);
  CHECK(alert.active);
  CHECK(alert.count == 2);
  CHECK(alert.raised_s == 100.0);
  CHECK(alert.newest_s == 102.0);
}

TEST_CASE("An acknowledged alert that is over is history, decisions count once they are adopted",
          "[operator][alerts]") {
  AlertRegistry registry;
  registry.Update(Lost("r1"), 100.0);
  registry.Adopt(*registry.Acknowledge(1, "anna", 101.0));
  CHECK(registry.Update(Lost("r1"), 102.0).changed.empty());
  registry.Update(Back("r1"), 103.0);
  registry.Update(Lost("r1"), 104.0);
  REQUIRE(registry.alerts().size() == 2);
  CHECK(registry.alerts().at(1).acknowledged_by == "anna");
  CHECK(registry.alerts().at(2).active);
  AlertRegistry pending;
  pending.Update(Lost("r1"), 100.0);
  const auto shelved = pending.Shelve(1, 60.0, 105.0);
  CHECK(shelved->shelved_until_s == 165.0);
  CHECK(pending.alerts().at(1).shelved_until_s == 0.0);
  pending.Adopt(*shelved);
  CHECK(pending.alerts().at(1).shelved_until_s == 165.0);
  CHECK_THAT(pending.Acknowledge(9, "anna", 1.0).error().text, Catch::Contains("9"));
  CHECK_FALSE(pending.Shelve(9, 1.0, 1.0));
}

// The faults report's S11: "Forged /diagnostics make rows without bound: 2473 processes and 4232 alerts
// from 3000 messages, stored and sent to each page; real alarms drown."
TEST_CASE("Of many warnings the oldest become history, alarms stay", "[operator][alerts]") {
  AlertRegistry registry;
  registry.Update(Lost("r1"), 100.0);
  std::size_t dropped = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string name = "forged-" + std::to_string(i);
    const Condition warning{"silent/" + name, Severity::kWarning, name, "is silent", "look"};
    dropped += registry.Update({{warning}, {}}, 101.0).dropped.size();
  }
  const auto kept = AlertRegistry::kWarningsKept + AlertRegistry::kHistoryKept;
  CHECK(registry.alerts().size() == 1 + kept);
  CHECK(dropped == 3000 - kept);
  CHECK(registry.alerts().at(1).condition == Link("r1"));
}

TEST_CASE("Alerts go on after a restart, and the newest of what is over and acknowledged are kept",
          "[operator][alerts]") {
  const Alert open{.id = 4, .condition = Link("r1"), .raised_s = 1.0, .newest_s = 1.0};
  const Alert read{.id = 7, .condition = Link("r2"), .acknowledged_by = "anna"};
  AlertRegistry registry;
  registry.Restore({open, read});
  CHECK(registry.Update({}, 8.0).changed.empty());  // nobody knows yet
  CHECK(registry.Update({{Link("r1"), Link("r2")}, {}}, 9.0).changed.empty());
  CHECK(registry.alerts() == std::map<std::uint64_t, Alert>{{4, open}, {7, read}});
  CHECK(registry.Update({{Link("r1")}, {"link/r2"}}, 10.0).changed.size() == 1);
  registry.Update(Lost("r2"), 11.0);
  CHECK(registry.alerts().at(8).condition == Link("r2"));
  AlertRegistry history;
  history.Update(Lost("r0"), 1.0);  // and nobody acknowledges it
  for (std::size_t i = 0; i <= AlertRegistry::kHistoryKept; ++i) {
    history.Update(Lost("r1"), 2.0);
    history.Adopt(*history.Acknowledge(history.alerts().rbegin()->first, "anna", 3.0));
    const auto dropped = history.Update(Back("r1"), 4.0).dropped;
    if (i < AlertRegistry::kHistoryKept) REQUIRE(dropped.empty());
    if (i == AlertRegistry::kHistoryKept) CHECK(dropped == std::vector<std::uint64_t>{2});
  }
  CHECK(history.alerts().size() == AlertRegistry::kHistoryKept + 1);
  CHECK(history.alerts().contains(1));
}

TEST_CASE(
    "robots that are lost or stand, processes that are silent or ill, and the disk are matters",
    "[operator][alerts]") {
  const Findings findings = FindingsOf(
      {{.name = "r1", .lost = true}, {.name = "r2", .stands = true}, {.name = "r3"}}, {}, {});
  REQUIRE(findings.wrong.size() == 2);
  CHECK(findings.wrong[0].key == "link/r1");
  CHECK(findings.wrong[0].severity == Severity::kAlarm);
  CHECK(findings.wrong[1].key == "command/r2");
  CHECK(std::ranges::count(findings.fine, "command/r1") == 1);
  CHECK(std::ranges::count(findings.fine, "link/r3") == 1);
  CHECK(std::ranges::count(findings.fine, "command/r2") == 0);
  const Findings field = FindingsOf({{.name = "r1",
                                      .resumed_elsewhere = true,
                                      .stop_unconfirmed = true,
                                      .map_problem = "another map",
                                      .goals_problem = "two writers"}},
                                    {}, {});
  REQUIRE(field.wrong.size() == 4);
  CHECK(field.wrong[0].key == "resumed/r1");
  CHECK(field.wrong[1].key == "stop/r1");
  CHECK(field.wrong[2].key == "map/r1");
  CHECK(field.wrong[2].text == "another map");
  CHECK(field.wrong[3].key == "goals/r1");
  CHECK(field.fine == Keys{"link/r1", "command/r1"});
  const std::vector<ProcessCondition> processes{{"sim", false, false, "fine"},
                                                {"nhpm", true, false, "no weights"},
                                                {"planner", true, true, "old", true}};
  const Findings others = FindingsOf({}, processes, "full");
  REQUIRE(others.wrong.size() == 4);
  CHECK(others.wrong[0].key == "health/nhpm");
  CHECK_THAT(others.wrong[0].text, Catch::Contains("no weights"));
  CHECK(others.wrong[1].key == "silent/planner");
  CHECK(others.wrong[2].key == "restarted/planner");
  CHECK(others.wrong[3].key == "storage");
  CHECK(others.fine == Keys{"silent/sim", "health/sim", "restarted/sim", "silent/nhpm",
                            "restarted/nhpm", "health/planner"});
  const Findings systems = FindingsOf({}, {}, std::nullopt, {{"lab", true}, {"old", false}});
  REQUIRE(systems.wrong.size() == 1);
  CHECK(systems.wrong[0].key == "system/lab");
  CHECK_THAT(systems.wrong[0].text, Catch::Contains("lab"));
  CHECK(systems.fine == Keys{"system/old"});
  CHECK(FindingsOf({}, {}, std::nullopt).fine.empty());
  CHECK(FindingsOf({}, {}, "").fine == Keys{"storage"});
}

TEST_CASE("a robot stands whose command failed, not one that asks something else",
          "[operator][alerts]") {
  const AttentionItem failed{.robot = "r1", .reason = AttentionReason::kCommandFailed};
  const AttentionItem lost{.robot = "r2", .reason = AttentionReason::kLinkLost};
  CHECK(Stands({lost, failed}, "r1"));
  CHECK_FALSE(Stands({lost, failed}, "r2"));
  CHECK_FALSE(Stands({}, "r1"));
}

TEST_CASE(
    "a host's clock is named when it is off by more than the limit and the error of its measure",
    "[operator][alerts]") {
  const auto wrong = [](double ahead_s, double error_s) {
    return FindingsOf({}, {}, std::nullopt, {}, {{"robot1", ahead_s, error_s}}).wrong;
  };
  CHECK(wrong(0.2, 0.0).empty());
  CHECK(wrong(-0.5, 0.3).empty());
  REQUIRE(wrong(-0.5, 0.1).size() == 1);
  CHECK(wrong(-0.5, 0.1)[0].source == "robot1");
  CHECK_THAT(wrong(-0.5, 0.1)[0].text, Catch::Contains("behind"));
  CHECK_THAT(wrong(0.5, 0.1)[0].text, Catch::Contains("ahead"));
}

}  // namespace
}  // namespace conav::operators
