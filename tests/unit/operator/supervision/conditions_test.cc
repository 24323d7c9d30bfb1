#include <catch2/catch.hpp>

#include "operator/supervision/alerts.h"

namespace conav::operators {
namespace {

using Keys = std::vector<std::string>;

TEST_CASE("a robot that is lost or stands is a matter, another one is fine", "[operator][alerts]") {
  const Findings findings = FindingsOf(
      {{.name = "r1", .lost = true}, {.name = "r2", .stands = true}, {.name = "r3"}}, {}, {});
  REQUIRE(findings.wrong.size() == 2);
  CHECK(findings.wrong[0].key == "link/r1");
  CHECK(findings.wrong[0].severity == Severity::kAlarm);
  CHECK(findings.wrong[1].key == "command/r2");
  CHECK(findings.fine == Keys{"command/r1", "link/r2", "link/r3", "command/r3"});
}

TEST_CASE("a robot stands whose command failed, not one that asks something else",
          "[operator][alerts]") {
  AttentionItem failed;
  failed.robot = "r1";
  failed.reason = AttentionReason::kCommandFailed;
  AttentionItem lost;
  lost.robot = "r2";
  lost.reason = AttentionReason::kLinkLost;
  CHECK(Stands({lost, failed}, "r1"));
  CHECK_FALSE(Stands({lost, failed}, "r2"));
  CHECK_FALSE(Stands({}, "r1"));
}

TEST_CASE("processes that are silent or ill, and the disk, are matters", "[operator][alerts]") {
  const std::vector<ProcessCondition> processes{{"sim", false, false, "fine"},
                                                {"nhpm", true, false, "no weights"},
                                                {"planner", true, true, "old"}};
  const Findings findings = FindingsOf({}, processes, "full");
  REQUIRE(findings.wrong.size() == 3);
  CHECK(findings.wrong[0].key == "health/nhpm");
  CHECK(findings.wrong[0].text == "nhpm: no weights");
  CHECK(findings.wrong[1].key == "silent/planner");
  CHECK(findings.wrong[2].key == "storage");
  CHECK(findings.fine == Keys{"silent/sim", "health/sim", "silent/nhpm", "health/planner"});
}

TEST_CASE("the disk is fine once something was stored, before that nobody knows",
          "[operator][alerts]") {
  CHECK(FindingsOf({}, {}, std::nullopt).fine.empty());
  CHECK(FindingsOf({}, {}, "").fine == Keys{"storage"});
}

}  // namespace
}  // namespace conav::operators
