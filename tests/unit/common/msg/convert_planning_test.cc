#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace samples;
using Report = conav_msgs::msg::SearchReport;
using Request = conav_msgs::msg::PerceptionRequest;
using Reply = conav_msgs::msg::PerceptionReply;

void CheckReplyRefused(void (*spoil)(Reply&), const std::string& text) {
  Reply message = ToMessage(SamplePerceptionReply());
  spoil(message);
  const auto result = ToDomain(message, 2, 3);
  REQUIRE_FALSE(result);
  CHECK(result.error().text == text);
}

TEST_CASE("Search reports, perception requests and replies survive the wire",
          "[protocol][convert]") {
  CheckRoundTrip(SampleReport());
  CheckRoundTrip(SampleRequest());
  const auto reply = ToDomain(ToMessage(SamplePerceptionReply()), 2, 3);
  REQUIRE(reply);
  CHECK(*reply == SamplePerceptionReply());
}

TEST_CASE("An empty batch survives the wire", "[protocol][convert]") {
  CheckRoundTrip(PerceptionRequest{.client = "c", .request_id = 1});
}

TEST_CASE("A malformed search report is refused", "[protocol][convert]") {
  CheckRefused(
      SampleReport(), [](Report& m) { m.method(""); }, "method is empty");
  CheckRefused(
      SampleReport(), [](Report& m) { m.chosen(2); }, "chosen = 2 is not in [-1, 1]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.chosen(-2); }, "chosen = -2 is not in [-1, 1]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.duration_ms(-1.0); },
      "duration_ms = -1 is not in [0, 1.7976931348623157e+308]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[1].kind(0); },
      "actions[1].kind = 0 is not in [1, 2]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[0].mean_value(NAN); },
      "actions[0].mean_value = nan is not finite");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[0].feasibility(1.5); },
      "actions[0].feasibility = 1.5 is not in [0, 1]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[0].information_gain(NAN); },
      "actions[0].information_gain = nan is not finite");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[0].target().row(-1); },
      "actions[0].target = (-1,2) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions().resize(4097); },
      "actions has size 4097, more than 4096");
}

TEST_CASE("A search report with a tree that is none is refused", "[protocol][convert]") {
  CheckRefused(
      SampleReport(), [](Report& m) { m.actions()[1].terms().guidance(NAN); },
      "actions[1].terms.guidance = nan is not finite");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[0].parent(0); }, "tree[0].parent = 0 is not -1");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[1].parent(-1); },
      "tree[1].parent = -1 is not in [0, 0]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[1].parent(1); },
      "tree[1].parent = 1 is not in [0, 0]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[1].kind(3); }, "tree[1].kind = 3 is not in [1, 2]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[1].heading(NAN); },
      "tree[1].heading = nan is not finite");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[0].mean_value(NAN); },
      "tree[0].mean_value = nan is not finite");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[0].feasibility(-0.5); },
      "tree[0].feasibility = -0.5 is not in [0, 1]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree()[0].target().column(1024); },
      "tree[0].target = (1,1024) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleReport(), [](Report& m) { m.tree().resize(257); }, "tree has size 257, more than 256");
}

TEST_CASE("A search report with views that are none is refused", "[protocol][convert]") {
  CheckRefused(
      SampleReport(), [](Report& m) { m.views()[1].cell().row(-1); },
      "views[1].cell = (-1,2) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleReport(), [](Report& m) { m.views()[0].information_gain(-1.0); },
      "views[0].information_gain = -1 is not in [0, 1.7976931348623157e+308]");
  CheckRefused(
      SampleReport(), [](Report& m) { m.views().resize(513); },
      "views has size 513, more than 512");
}

TEST_CASE("A malformed perception request is refused", "[protocol][convert]") {
  CheckRefused(
      SampleRequest(), [](Request& m) { m.client("a b"); },
      "client = 'a b' has a character outside of [A-Za-z0-9_.:@/-]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.request_id(0); }, "request_id = 0 is below 1");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.replica("a b"); },
      "replica = 'a b' has a character outside of [A-Za-z0-9_.:@/-]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.person("../anna"); },
      "person = '../anna' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.model_checksum("abc"); },
      "model_checksum = 'abc' is not 64 hexadecimal digits");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.rows(4); }, "queries[0].belief has size 6, not 4 x 3");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.rows(0); }, "rows = 0 is not in [1, 1024]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.columns(4'000'000'000); },
      "columns = 4000000000 is not in [1, 1024]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries()[1].belief()[2] = -0.5F; },
      "queries[1].belief[2] = -0.5 is not in [0, 1]");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries()[0].path()[1].row(2); },
      "queries[0].path[1] = (2,2) is outside of 2 x 3 cells");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries()[0].cell().column(3); },
      "queries[0].cell = (1,3) is outside of 2 x 3 cells");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries()[0].heading(NAN); },
      "queries[0].heading = nan is not finite");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries()[1].free_cells()[0].row(9); },
      "queries[1].free_cells[0] = (9,0) is outside of 2 x 3 cells");
  CheckRefused(
      SampleRequest(), [](Request& m) { m.queries().resize(1025); },
      "queries has size 1025, more than 1024");
  CheckRefused(
      SampleRequest(),
      [](Request& m) {
        m.queries().resize(17);
        m.rows(1024);
        m.columns(1024);
      },
      "queries * rows * columns has size 17825792, more than 16777216");
}

TEST_CASE("A malformed perception reply is refused", "[protocol][convert]") {
  CheckReplyRefused([](Reply& m) { m.status(3); }, "status = 3 is not in [0, 2]");
  CheckReplyRefused([](Reply& m) { m.model_checksum(std::string(64, 'G')); },
                    "model_checksum = 'GGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGGG' is not 64 "
                    "hexadecimal digits");
  CheckReplyRefused([](Reply& m) { m.replica("a b"); },
                    "replica = 'a b' has a character outside of [A-Za-z0-9_.:@/-]");
  CheckReplyRefused([](Reply& m) { m.client(""); }, "client is empty");
  CheckReplyRefused([](Reply& m) { m.answers()[1].add()[0] = NAN; },
                    "answers[1].add[0] = nan is not in [0, 1]");
  CheckReplyRefused([](Reply& m) { m.answers()[0].remove().clear(); },
                    "answers[0].remove has size 0, not 2 x 3");
  CheckReplyRefused([](Reply& m) { m.answers().resize(1025); },
                    "answers has size 1025, more than 1024");
}

TEST_CASE("Expected edits are the sum of both grids", "[protocol]") {
  CHECK(ExpectedEdits({Grid<float>(2, 2, 0.25F), Grid<float>(2, 2, 0.5F)}) == 3.0);
  CHECK(ExpectedEdits({}) == 0.0);
}

}  // namespace
}  // namespace conav
