#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace samples;
using BeliefMessage = conav_msgs::msg::BeliefMap;
using GuidanceMessage = conav_msgs::msg::Guidance;
using RequestMessage = conav_msgs::msg::OperatorRequest;
using ReplyMessage = conav_msgs::msg::OperatorReply;
using AttentionMessage = conav_msgs::msg::AttentionRequest;

TEST_CASE("The operator's values survive the wire", "[protocol][convert]") {
  CheckRoundTrip(SampleBelief());
  CheckRoundTrip(SampleGuidance());
  CheckRoundTrip(SampleEdit());
  CheckRoundTrip(SampleGuide());
  CheckRoundTrip(SampleDrive());
  CheckRoundTrip(SampleDriveOrder());
  CheckRoundTrip(SampleStop());
  for (const OperatorRequest& request : SampleControlRequests()) CheckRoundTrip(request);
  CheckRoundTrip(SampleReply());
  CheckRoundTrip(SampleSelect());
  CheckRoundTrip(SampleAttention());
  CheckRoundTrip(SampleQueue());
}

TEST_CASE("A withdrawn guidance and an initial belief survive the wire", "[protocol][convert]") {
  Guidance guidance = SampleGuidance();
  guidance.path.clear();
  CheckRoundTrip(guidance);
  Belief belief = SampleBelief();
  belief.revision = 0;
  belief.edited_by.clear();
  CheckRoundTrip(belief);
}

TEST_CASE("A malformed belief is refused", "[protocol][convert]") {
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.wall_probability()[4] = NAN; },
      "wall_probability[4] = nan is not in [0, 1]");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.wall_probability()[0] = 1.5F; },
      "wall_probability[0] = 1.5 is not in [0, 1]");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.wall_probability().pop_back(); },
      "wall_probability has size 5, not 2 x 3");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.rows(1025); }, "rows = 1025 is not in [1, 1024]");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.columns(0); }, "columns = 0 is not in [1, 1024]");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.world(""); }, "world is empty");
  CheckRefused(
      SampleBelief(), [](BeliefMessage& m) { m.edited_by("a b"); },
      "edited_by = 'a b' has a character outside of [A-Za-z0-9_.:@/-]");
}

TEST_CASE("A malformed guidance is refused", "[protocol][convert]") {
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.revision(0); }, "revision = 0 is below 1");
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.path()[1].column(5); },
      "path[1] = (1,5) is not a neighbour of (1,1)");
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.path()[2].row(-1); },
      "path[2] = (-1,2) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.valid_until().sec(-1); },
      "valid_until.sec = -1 is below 0");
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.robot("r-1"); },
      "robot = 'r-1' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      SampleGuidance(), [](GuidanceMessage& m) { m.given_by(std::string(129, 'a')); },
      "given_by has size 129, more than 128");
}

TEST_CASE("A malformed operator request is refused", "[protocol][convert]") {
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.kind(13); }, "kind = 13 is not in [1, 12]");
  CheckRefused(
      SampleSelect(), [](RequestMessage& m) { m.robot(""); }, "robot is empty");
  CheckRefused(
      SampleSelect(), [](RequestMessage& m) { m.attention_reason(0); },
      "attention_reason = 0 is not in [1, 7]");
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.client(""); }, "client is empty");
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.request_id(0); }, "request_id = 0 is below 1");
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.edits()[1].cell().row(-2); },
      "edits[1].cell = (-2,4) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.edits().resize(65537); },
      "edits has size 65537, more than 65536");
  CheckRefused(
      SampleGuide(), [](RequestMessage& m) { m.robot(""); }, "robot is empty");
  CheckRefused(
      SampleGuide(), [](RequestMessage& m) { m.valid_for(0.0); }, "valid_for = 0 is not above 0");
  CheckRefused(
      SampleGuide(), [](RequestMessage& m) { m.valid_for(std::nan("")); },
      "valid_for = nan is not finite");
  CheckRefused(
      SampleGuide(), [](RequestMessage& m) { m.path()[0].row(1024); },
      "path[0] = (1024,2) is outside of 1024 x 1024 cells");
}

TEST_CASE("A malformed low-level action is refused", "[protocol][convert]") {
  using OrderMessage = conav_msgs::msg::DriveOrder;
  CheckRefused(
      SampleDrive(), [](RequestMessage& m) { m.drive(5); }, "drive = 5 is not in [0, 4]");
  CheckRefused(
      SampleDrive(), [](RequestMessage& m) { m.robot("r 1"); },
      "robot = 'r 1' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      SampleDrive(), [](RequestMessage& m) { m.expires_at().sec(-1); },
      "expires_at.sec = -1 is below 0");
  CheckRefused(
      SampleDriveOrder(), [](OrderMessage& m) { m.drive(9); }, "drive = 9 is not in [0, 4]");
  CheckRefused(
      SampleDriveOrder(), [](OrderMessage& m) { m.sequence_number(0); },
      "sequence_number = 0 is below 1");
  CheckRefused(
      SampleDriveOrder(), [](OrderMessage& m) { m.world(""); }, "world is empty");
}

TEST_CASE("A stop of all robots names no world, an edit does", "[protocol][convert]") {
  CheckRoundTrip(OperatorRequest{Stamp(8), "browser-1", 7, "", StopRequest{{}, ""}});
  CheckRefused(
      SampleEdit(), [](RequestMessage& m) { m.world(""); }, "world is empty");
}

TEST_CASE("A malformed control request or hold order is refused", "[protocol][convert]") {
  const auto samples = SampleControlRequests();
  CheckRefused(
      samples[0], [](RequestMessage& m) { m.answers_snapshot(0); },
      "answers_snapshot = 0 is below 1");
  CheckRefused(
      samples[1], [](RequestMessage& m) { m.robots()[1] = "r 2"; },
      "robots[1] = 'r 2' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      samples[1], [](RequestMessage& m) { m.robots().resize(5000, "r1"); },
      "robots has size 5000, more than 4096");
  CheckRefused(
      samples[6], [](RequestMessage& m) { m.duration(0.0); }, "duration = 0 is not above 0");
  CheckRefused(
      samples[6], [](RequestMessage& m) { m.duration(NAN); }, "duration = nan is not finite");
  using StopMessage = conav_msgs::msg::StopOrder;
  CheckRefused(
      SampleStop(), [](StopMessage& m) { m.revision(0); }, "revision = 0 is below 1");
  CheckRefused(
      SampleStop(), [](StopMessage& m) { m.robot(""); }, "robot is empty");
}

TEST_CASE("Texts in another encoding come in as UTF-8", "[protocol][convert]") {
  StopOrder hold = SampleStop();
  hold.reason = "caf\xE9";
  const auto read = ToDomain(ToMessage(hold));
  REQUIRE(read);
  CHECK(read->reason == "caf?");
}

TEST_CASE("A malformed reply or attention request is refused", "[protocol][convert]") {
  CheckRefused(
      SampleReply(), [](ReplyMessage& m) { m.request_id(0); }, "request_id = 0 is below 1");
  CheckRefused(
      SampleReply(), [](ReplyMessage& m) { m.reason(std::string(5000, 'x')); },
      "reason has size 5000, more than 4096");
  CheckRefused(
      SampleAttention(), [](AttentionMessage& m) { m.reason(4); }, "reason = 4 is not in [0, 3]");
  CheckRefused(
      SampleAttention(), [](AttentionMessage& m) { m.value_lost_per_second(INFINITY); },
      "value_lost_per_second = inf is not finite");
  CheckRefused(
      SampleAttention(), [](AttentionMessage& m) { m.expected_information(NAN); },
      "expected_information = nan is not finite");
  CheckRefused(
      SampleAttention(), [](AttentionMessage& m) { m.gives_up_after(-1.0); },
      "gives_up_after = -1 is not in [0, 1000000000000]");
}

TEST_CASE("A malformed attention queue is refused", "[protocol][convert]") {
  using Message = conav_msgs::msg::AttentionQueue;
  CheckRefused(
      SampleQueue(), [](Message& m) { m.order(""); }, "order is empty");
  CheckRefused(
      SampleQueue(), [](Message& m) { m.items()[1].reason(0); },
      "items.reason = 0 is not in [1, 7]");
  CheckRefused(
      SampleQueue(), [](Message& m) { m.items()[0].tier(6); }, "items.tier = 6 is not in [1, 5]");
  CheckRefused(
      SampleQueue(), [](Message& m) { m.items()[0].expected_interaction(-1.0); },
      "items.expected_interaction = -1 is not in [0, 1000000000000]");
  CheckRefused(
      SampleQueue(), [](Message& m) { m.items()[0].score(NAN); },
      "items.score = nan is not finite");
  CheckRefused(
      SampleQueue(), [](Message& m) { m.utilisation(1.5); }, "utilisation = 1.5 is not in [0, 1]");
}

}  // namespace
}  // namespace conav
