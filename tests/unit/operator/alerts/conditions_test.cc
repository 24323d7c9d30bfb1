#include "operator/alerts/conditions.h"

#include <catch2/catch.hpp>

namespace conav::operators {
namespace {

AttentionItem ItemOf(AttentionReason reason) {
  AttentionItem item;
  item.robot = "r1";
  item.reason = reason;
  return item;
}

TEST_CASE("what robots ask is no condition, that they stand or are silent is",
          "[operator][alerts]") {
  const auto conditions =
      ConditionsOf({ItemOf(AttentionReason::kPicture), ItemOf(AttentionReason::kLinkLost),
                    ItemOf(AttentionReason::kBlocked), ItemOf(AttentionReason::kCommandFailed)},
                   std::vector<ProcessCondition>{}, "");
  REQUIRE(conditions.size() == 2);
  CHECK(conditions[0].key == "link/r1");
  CHECK(conditions[0].severity == Severity::kAlarm);
  CHECK(conditions[1].key == "command/r1");
}

TEST_CASE("processes that are silent or ill, and the disk, are conditions", "[operator][alerts]") {
  const auto conditions =
      ConditionsOf({},
                   std::vector<ProcessCondition>{{"sim", false, false, "fine"},
                                                 {"nhpm", true, false, "no weights"},
                                                 {"planner", true, true, "old"}},
                   "full");
  REQUIRE(conditions.size() == 3);
  CHECK(conditions[0].key == "health/nhpm");
  CHECK(conditions[0].text == "nhpm: no weights");
  CHECK(conditions[1].key == "silent/planner");
  CHECK(conditions[2].key == "storage");
}

}  // namespace
}  // namespace conav::operators
