#include <decisions.pb.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "planner/explain/decision_file.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

decisions::Decision Sample() { return ToRecord(SampleDecision()).decision(); }

void CheckRefused(void (*spoil)(decisions::Decision&), const std::string& text) {
  decisions::Decision record = Sample();
  spoil(record);
  const auto result = ToDomain(record);
  REQUIRE_FALSE(result);
  CHECK(result.error().text == text);
}

TEST_CASE("decisions come back from their records", "[planner][record]") {
  for (const DecisionRecord& decision :
       {SampleDecision(), SampleSnapshot(3), SampleWithoutSearch(), SampleLowLevelAction()}) {
    const auto back = ToDomain(ToRecord(decision).decision());
    REQUIRE(back);
    CHECK(*back == decision);
  }
}

TEST_CASE("cells that the robot's map does not have are left out", "[planner][record]") {
  DecisionRecord decision = SampleDecision();
  decision.guidance.push_back({7, 7});
  const auto back = ToDomain(ToRecord(decision).decision());
  REQUIRE(back);
  CHECK(back->guidance == SampleDecision().guidance);
}

TEST_CASE("maps that are none are refused", "[planner][record]") {
  CheckRefused([](auto& r) { r.set_rows(0); }, "the map is 0 x 5; each side must be in [1, 1024]");
  CheckRefused([](auto& r) { r.set_columns(1025); },
               "the map is 5 x 1025; each side must be in [1, 1024]");
  CheckRefused([](auto& r) { r.set_rows(4); },
               "25 cells of the robot's map and 25 of the operator's where 4 x 5 are said");
  CheckRefused([](auto& r) { (*r.mutable_map())[3] = '\3'; }, "the map has the value 3");
  CheckRefused([](auto& r) { r.mutable_belief()->RemoveLast(); },
               "25 cells of the robot's map and 24 of the operator's where 5 x 5 are said");
  CheckRefused([](auto& r) { r.set_belief(2, 1.5F); }, "the belief 1.5 is outside of [0, 1]");
  CheckRefused([](auto& r) { r.set_belief(2, NAN); }, "the belief nan is outside of [0, 1]");
}

TEST_CASE("cells, actions and trees that are none are refused", "[planner][record]") {
  CheckRefused([](auto& r) { r.set_cell(25); }, "robot: there is no cell 25");
  CheckRefused([](auto& r) { r.set_path(0, 99); }, "path: there is no cell 99");
  CheckRefused([](auto& r) { r.set_chosen(4); }, "chosen: there is no action 4");
  CheckRefused([](auto& r) { r.mutable_taken()->set_kind(0); },
               "taken: there is no action of kind 0");
  CheckRefused([](auto& r) { r.mutable_taken()->set_kind(4); },
               "taken: there is no action of kind 4");
  CheckRefused([](auto& r) { r.mutable_actions(1)->set_kind(3); },
               "action: there is no action of kind 3");
  CheckRefused([](auto& r) { r.mutable_actions(1)->set_mean_value(NAN); },
               "action: nan is no number");
  CheckRefused([](auto& r) { r.mutable_actions(1)->add_terms(1.0); },
               "action: 8 terms where 7 make a value");
  CheckRefused([](auto& r) { r.mutable_tree()->add_parent(0); }, "tree: columns of 6 and 5 nodes");
  CheckRefused([](auto& r) { r.mutable_tree()->set_parent(2, 2); },
               "tree: node 2 cannot have the parent 2");
  CheckRefused([](auto& r) { r.mutable_tree()->set_parent(1, -1); },
               "tree: node 1 cannot have the parent -1");
  CheckRefused([](auto& r) { r.mutable_views()->add_cell(1); },
               "views: columns of different lengths");
}

}  // namespace
}  // namespace conav::planner
