#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace samples;
using BeliefMessage = conav_msgs::msg::BeliefMap;
using GuidanceMessage = conav_msgs::msg::Guidance;
using Request = conav_msgs::msg::OperatorRequest;
using ReplyMessage = conav_msgs::msg::OperatorReply;
using AttentionMessage = conav_msgs::msg::AttentionRequest;

TEST_CASE("The operator's values survive the wire, also those that name nothing", "[convert]") {
  for (const OperatorRequest& request : SampleControlRequests()) CheckRoundTrips(request);
  Guidance guidance = SampleGuidance();
  guidance.path.clear();
  Belief belief = SampleBelief();
  belief.revision = 0;
  belief.edited_by.clear();
  CheckRoundTrips(SampleBelief(), belief, SampleGuidance(), guidance, SampleEdit(), SampleGuide(),
                  SampleDrive(), SampleDriveOrder(), SampleStop(), SampleReply(), SampleEvent(),
                  SampleSelect(), SampleAttention(), SampleQueue(),
                  OperatorRequest{Stamp(8), "browser-1", 7, "", StopRequest{{}, ""}});
}

TEST_CASE("A malformed belief, guidance or order to a robot is refused", "[convert]") {
  CheckRefused(
      SampleBelief(),
      {
          {"wall_probability[4]", [](BeliefMessage& m) { m.wall_probability()[4] = NAN; }},
          {"wall_probability[0]", [](BeliefMessage& m) { m.wall_probability()[0] = 1.5F; }},
          {"wall_probability", [](BeliefMessage& m) { m.wall_probability().pop_back(); }},
          {"rows", [](BeliefMessage& m) { m.map_info().height(2049); }},
          {"columns", [](BeliefMessage& m) { m.map_info().width(0); }},
          {"map_info.resolution", [](BeliefMessage& m) { m.map_info().resolution(0.0F); }},
          {"world", [](BeliefMessage& m) { m.world(""); }},
          {"edited_by", [](BeliefMessage& m) { m.edited_by("a b"); }},
      });
  CheckRefused(SampleGuidance(),
               {
                   {"revision", [](GuidanceMessage& m) { m.revision(0); }},
                   {"path[1]", [](GuidanceMessage& m) { m.path()[1].column(5); }},
                   {"path[2]", [](GuidanceMessage& m) { m.path()[2].row(-1); }},
                   {"valid_until.sec", [](GuidanceMessage& m) { m.valid_until().sec(-1); }},
                   {"robot", [](GuidanceMessage& m) { m.robot("r-1"); }},
                   {"given_by", [](GuidanceMessage& m) { m.given_by(std::string(129, 'a')); }},
               });
  using Drive = conav_msgs::msg::DriveOrder;
  CheckRefused(SampleDriveOrder(), {
                                       {"drive", [](Drive& m) { m.drive(9); }},
                                       {"sequence_number", [](Drive& m) { m.sequence_number(0); }},
                                       {"world", [](Drive& m) { m.world(""); }},
                                   });
  using Stop = conav_msgs::msg::StopOrder;
  CheckRefused(SampleStop(), {
                                 {"revision", [](Stop& m) { m.revision(0); }},
                                 {"robot", [](Stop& m) { m.robot(""); }},
                             });
}

TEST_CASE("A malformed operator request is refused", "[convert]") {
  CheckRefused(SampleEdit(), {
                                 {"kind", [](Request& m) { m.kind(15); }},
                                 {"world", [](Request& m) { m.world(""); }},
                                 {"client", [](Request& m) { m.client(""); }},
                                 {"request_id", [](Request& m) { m.request_id(0); }},
                                 {"edits[1].cell", [](Request& m) { m.edits()[1].cell().row(-2); }},
                                 {"edits", [](Request& m) { m.edits().resize(65537); }},
                             });
  CheckRefused(SampleSelect(), {
                                   {"robot", [](Request& m) { m.robot(""); }},
                                   {"attention_reason", [](Request& m) { m.attention_reason(0); }},
                               });
  CheckRefused(SampleGuide(), {
                                  {"robot", [](Request& m) { m.robot(""); }},
                                  {"valid_for", [](Request& m) { m.valid_for(0.0); }},
                                  {"valid_for", [](Request& m) { m.valid_for(NAN); }},
                                  {"path[0]", [](Request& m) { m.path()[0].row(2048); }},
                              });
  CheckRefused(SampleDrive(), {
                                  {"drive", [](Request& m) { m.drive(5); }},
                                  {"robot", [](Request& m) { m.robot("r 1"); }},
                                  {"expires_at.sec", [](Request& m) { m.expires_at().sec(-1); }},
                              });
  const auto samples = SampleControlRequests();
  CheckRefused(samples[0], {{"answers_snapshot", [](Request& m) { m.answers_snapshot(0); }}});
  CheckRefused(samples[1], {
                               {"robots[1]", [](Request& m) { m.robots()[1] = "r 2"; }},
                               {"robots", [](Request& m) { m.robots().resize(5000, "r1"); }},
                           });
  CheckRefused(samples[6], {
                               {"duration", [](Request& m) { m.duration(0.0); }},
                               {"duration", [](Request& m) { m.duration(NAN); }},
                           });
  CheckRefused(samples.back(), {{"reason", [](Request& m) { m.reason(""); }}});
}

TEST_CASE("Texts in another encoding come in as UTF-8", "[convert]") {
  StopOrder stop = SampleStop();
  stop.reason = "caf\xE9";
  const auto read = ToDomain(ToMessage(stop));
  REQUIRE(read);
  CHECK(read->reason == "caf?");
}

TEST_CASE("A malformed reply, attention request or attention queue is refused", "[convert]") {
  CheckRefused(SampleReply(),
               {
                   {"request_id", [](ReplyMessage& m) { m.request_id(0); }},
                   {"reason", [](ReplyMessage& m) { m.reason(std::string(5000, 'x')); }},
               });
  using EventMessage = conav_msgs::msg::OperatorEvent;
  CheckRefused(SampleEvent(), {
                                  {"kind", [](EventMessage& m) { m.kind(15); }},
                                  {"robot", [](EventMessage& m) { m.robot("r 1"); }},
                              });
  CheckRefused(
      SampleAttention(),
      {
          {"reason", [](AttentionMessage& m) { m.reason(4); }},
          {"value_lost_per_second", [](AttentionMessage& m) { m.value_lost_per_second(INFINITY); }},
          {"expected_information", [](AttentionMessage& m) { m.expected_information(NAN); }},
          {"gives_up_after", [](AttentionMessage& m) { m.gives_up_after(-1.0); }},
      });
  using Message = conav_msgs::msg::AttentionQueue;
  CheckRefused(SampleQueue(), {
                                  {"order", [](Message& m) { m.order(""); }},
                                  {"items.reason", [](Message& m) { m.items()[1].reason(0); }},
                                  {"items.tier", [](Message& m) { m.items()[0].tier(6); }},
                                  {"items.expected_interaction",
                                   [](Message& m) { m.items()[0].expected_interaction(-1.0); }},
                                  {"items.score", [](Message& m) { m.items()[0].score(NAN); }},
                                  {"utilisation", [](Message& m) { m.utilisation(1.5); }},
                              });
}

}  // namespace
}  // namespace conav
