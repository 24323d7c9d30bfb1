#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace samples;
using Report = conav_msgs::msg::SearchReport;
using Reply = conav_msgs::msg::PerceptionReply;

PlannerLease SampleLease() {
  return {.node = "planner-2",
          .instance = "0193-ab12-planner-2",
          .robots = {"r1", "r2"},
          .holds = {{"r2", 7}},
          .load = 0.25};
}

IntendedPath SampleIntendedPath() {
  return {"r1", {{1, 2}, {1, 3}}, {{{2, 2}}, {RightOfWay::kHasPath, "r2", 3}}};
}

TEST_CASE("Values of planning survive the wire", "[convert]") {
  const auto reply = ToDomain(ToMessage(SamplePerceptionReply()), 2, 3);
  REQUIRE(reply);
  CHECK(*reply == SamplePerceptionReply());
  PlannerLease farewell = SampleLease();
  farewell.holds.clear();
  farewell.leaving = true;
  CheckRoundTrips(SampleReport(), SampleRequest(),
                  PerceptionRequest{.client = "c", .request_id = 1}, SampleLease(), farewell,
                  SampleIntendedPath(), IntendedPath{"r1", {}, {}});
}

TEST_CASE("A malformed search report is refused", "[convert]") {
  CheckRefused(
      SampleReport(),
      {
          {"method", [](Report& m) { m.method(""); }},
          {"chosen", [](Report& m) { m.chosen(2); }},
          {"chosen", [](Report& m) { m.chosen(-2); }},
          {"duration_ms", [](Report& m) { m.duration_ms(-1.0); }},
          {"actions[1].kind", [](Report& m) { m.actions()[1].kind(0); }},
          {"actions[0].mean_value", [](Report& m) { m.actions()[0].mean_value(NAN); }},
          {"actions[0].feasibility", [](Report& m) { m.actions()[0].feasibility(1.5); }},
          {"actions[0].information_gain", [](Report& m) { m.actions()[0].information_gain(NAN); }},
          {"actions[0].target", [](Report& m) { m.actions()[0].target().row(-1); }},
          {"actions", [](Report& m) { m.actions().resize(4097); }},
          {"actions[1].terms.guidance", [](Report& m) { m.actions()[1].terms().guidance(NAN); }},
          {"tree[0].parent", [](Report& m) { m.tree()[0].parent(0); }},
          {"tree[1].parent", [](Report& m) { m.tree()[1].parent(-1); }},
          {"tree[1].parent", [](Report& m) { m.tree()[1].parent(1); }},
          {"tree[1].kind", [](Report& m) { m.tree()[1].kind(3); }},
          {"tree[1].heading", [](Report& m) { m.tree()[1].heading(NAN); }},
          {"tree[0].mean_value", [](Report& m) { m.tree()[0].mean_value(NAN); }},
          {"tree[0].feasibility", [](Report& m) { m.tree()[0].feasibility(-0.5); }},
          {"tree[0].target", [](Report& m) { m.tree()[0].target().column(2048); }},
          {"tree", [](Report& m) { m.tree().resize(257); }},
          {"views[1].cell", [](Report& m) { m.views()[1].cell().row(-1); }},
          {"views[0].information_gain", [](Report& m) { m.views()[0].information_gain(-1.0); }},
          {"views", [](Report& m) { m.views().resize(513); }},
      });
}

TEST_CASE("A malformed perception request is refused", "[convert]") {
  using Request = conav_msgs::msg::PerceptionRequest;
  CheckRefused(
      SampleRequest(),
      {
          {"client", [](Request& m) { m.client("a b"); }},
          {"request_id", [](Request& m) { m.request_id(0); }},
          {"replica", [](Request& m) { m.replica("a b"); }},
          {"person", [](Request& m) { m.person("../anna"); }},
          {"model_checksum", [](Request& m) { m.model_checksum("abc"); }},
          {"queries[0].belief", [](Request& m) { m.rows(4); }},
          {"rows", [](Request& m) { m.rows(0); }},
          {"columns", [](Request& m) { m.columns(4'000'000'000); }},
          {"queries[1].belief[2]", [](Request& m) { m.queries()[1].belief()[2] = -0.5F; }},
          {"queries[0].path[1]", [](Request& m) { m.queries()[0].path()[1].row(2); }},
          {"queries[0].cell", [](Request& m) { m.queries()[0].cell().column(3); }},
          {"queries[0].heading", [](Request& m) { m.queries()[0].heading(NAN); }},
          {"queries[1].free_cells[0]", [](Request& m) { m.queries()[1].free_cells()[0].row(9); }},
          {"queries", [](Request& m) { m.queries().resize(1025); }},
          {"queries * rows * columns",
           [](Request& m) {
             m.queries().resize(17);
             m.rows(1024);
             m.columns(1024);
           }},
      });
}

TEST_CASE("A malformed perception reply is refused", "[convert]") {
  CheckRefused(SamplePerceptionReply(),
               {
                   {"status", [](Reply& m) { m.status(3); }},
                   {"model_checksum", [](Reply& m) { m.model_checksum(std::string(64, 'G')); }},
                   {"replica", [](Reply& m) { m.replica("a b"); }},
                   {"client", [](Reply& m) { m.client(""); }},
                   {"answers[1].add[0]", [](Reply& m) { m.answers()[1].add()[0] = NAN; }},
                   {"answers[0].remove", [](Reply& m) { m.answers()[0].remove().clear(); }},
                   {"answers", [](Reply& m) { m.answers().resize(1025); }},
               },
               2, 3);
}

TEST_CASE("Expected edits are the sum of both grids", "[protocol]") {
  CHECK(ExpectedEdits({Grid<float>(2, 2, 0.25F), Grid<float>(2, 2, 0.5F)}) == 3.0);
  CHECK(ExpectedEdits({}) == 0.0);
}

TEST_CASE("A malformed planner lease or intended path is refused", "[convert]") {
  using Message = conav_msgs::msg::PlannerLease;
  CheckRefused(
      SampleLease(),
      {
          {"node", [](Message& message) { message.node("a b"); }},
          {"instance", [](Message& message) { message.instance(""); }},
          {"robots", [](Message& message) { message.robots()[1] = "r1"; }},
          {"holds[0].lease_epoch", [](Message& message) { message.holds()[0].lease_epoch(0); }},
          {"holds", [](Message& message) { message.holds().push_back(message.holds()[0]); }},
          {"leaving", [](Message& message) { message.leaving(true); }},
          {"load", [](Message& message) { message.load(-1.0); }},
      });
  using Path = conav_msgs::msg::IntendedPath;
  CheckRefused(SampleIntendedPath(), {
                                         {"robot", [](Path& path) { path.robot(""); }},
                                         {"room_tier", [](Path& path) { path.room_tier(4); }},
                                     });
}

}  // namespace
}  // namespace conav
