#include "common/bus/service.h"

#include <catch2/catch.hpp>

#include "common/bus/action.h"
#include "common/bus/in_memory_bus.h"
#include "common/bus/type_support_of.h"

namespace conav::bus {
namespace {

using std_srvs::srv::SetBool_Request;
using std_srvs::srv::SetBool_Response;
using std_srvs::srv::Trigger_Response;

constexpr GoalId kFirstGoal{1};
constexpr GoalId kSecondGoal{2};

std::vector<std::uint8_t> PayloadOf(const TypeSupport& type, const void* message) {
  std::vector<std::uint8_t> payload(PayloadSize(type, message));
  payload.resize(ToPayload(type, message, payload));
  return payload;
}

TEST_CASE("a request has its client and number before it, as rmw_cyclonedds_cpp writes them",
          "[service]") {
  const Envelope<SetBool_Request> request = [] {
    Envelope<SetBool_Request> made{{{0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18}, 0x0203}, {}};
    made.message.data(true);
    return made;
  }();
  const TypeSupport& type = TypeSupportOf<Envelope<SetBool_Request>>();
  CHECK(type.name == "std_srvs::srv::dds_::SetBool_Request_");
  const std::vector<std::uint8_t> expected = {
      0,    1,    0,    0,                             // little-endian CDR
      0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18,  // uint64 guid
      3,    2,    0,    0,    0,    0,    0,    0,     // int64 seq
      1};                                              // data
  CHECK(PayloadOf(type, &request) == expected);

  Envelope<SetBool_Request> received;
  REQUIRE(FromPayload(type, expected, &received));
  CHECK(received.id == request.id);
  CHECK(received.message.data());

  const std::vector<std::uint8_t> big_endian = {
      0, 0, 0, 0, 0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0, 0, 0, 0, 0, 0, 2, 3, 1};
  REQUIRE(FromPayload(type, big_endian, &received));
  CHECK(received.id == request.id);
  for (std::size_t size = 0; size < expected.size(); ++size) {
    CHECK_FALSE(FromPayload(type, std::span(expected).first(size), &received));
  }
}

TEST_CASE("a message keeps its alignment behind the header", "[service]") {
  Envelope<Trigger_Response> reply{{{7}, 1}, {}};
  reply.message.success(true);
  reply.message.message("ok");
  const TypeSupport& type = TypeSupportOf<Envelope<Trigger_Response>>();
  const std::vector<std::uint8_t> expected = {0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 1,   0,   0, 0,
                                              0, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 'o', 'k', 0};
  CHECK(PayloadOf(type, &reply) == expected);
  // Without the header, as rmw_fastrtps_cpp writes it.
  std::vector<std::uint8_t> body(type.serialized_size(&reply));
  body.resize(type.serialize(&reply, body));
  CHECK(body == std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 'o', 'k', 0});
}

TEST_CASE("the result of an action is read in the layouts of Humble, Jazzy and Kilted",
          "[service]") {
  using Response = nav2_msgs::action::NavigateToPose_GetResult_Response;
  const TypeSupport& type = TypeSupportOf<Envelope<Response>>();
  const std::vector<std::uint8_t> header = {0, 1, 0, 0, 9, 0, 0, 0, 0, 0,
                                            0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  const auto read = [&](std::vector<std::uint8_t> body) {
    body.insert(body.begin(), header.begin(), header.end());
    Envelope<Response> received;
    REQUIRE(FromPayload(type, body, &received));
    return received.message;
  };
  CHECK(read({4, 0}).status() == 4);
  CHECK(read({6, 0, 0x66, 0}).result().error_code() == 0x66);
  CHECK(read({6, 0, 0x66, 0, 3, 0, 0, 0, 'n', 'o', 0}).result().error_code() == 0x66);
}

struct TwoNodes {
  std::shared_ptr<InMemoryBus> bus = std::make_shared<InMemoryBus>();
  Participant left{"left", bus};
  Participant right{"right", bus};
};

// Seen with a real Humble: "Change payload size of '24' bytes is larger than the history payload size
// of '11' bytes and cannot be resized", and the client waits for ever.
TEST_CASE("the result of an action is no longer than what Humble reserves for it", "[service]") {
  const Envelope<nav2_msgs::action::NavigateToPose_GetResult_Response> reply{};
  const TypeSupport& type =
      TypeSupportOf<Envelope<nav2_msgs::action::NavigateToPose_GetResult_Response>>();
  CHECK(type.serialized_size(&reply) <= 11);
}

TEST_CASE("replies go to the client that asked, now or later", "[service]") {
  TwoNodes pair;
  ServiceServer server(pair.left, kPauseService, "w1");
  ServiceClient<SetBool_Request, SetBool_Response> client(pair.right, "/w1/pause");
  ServiceClient<SetBool_Request, SetBool_Response> other(pair.right, "/w1/pause");
  SetBool_Request request;
  const auto first = client.Call(request);
  request.data(true);
  const auto second = client.Call(request);
  REQUIRE((first && second && *first != *second));
  const auto calls = server.Take();
  REQUIRE(calls.size() == 2);
  for (const auto& call : {calls[1], calls[0]}) {
    SetBool_Response response;
    response.success(call.request.data());
    server.Reply(call.id, response);
  }
  const auto replies = client.Take();
  REQUIRE(replies.size() == 2);
  CHECK(replies[0].number == second);
  CHECK(replies[0].response.success());
  CHECK(replies[1].number == first);
  CHECK_FALSE(replies[1].response.success());
  CHECK(other.Take().empty());
}

TEST_CASE("a reply waits for a client that is not there yet for replies", "[service]") {
  TwoNodes pair;
  ServiceServer server(pair.left, kPauseService, "w1");
  Publisher<Envelope<SetBool_Request>> requests(pair.right,
                                                {"rq/w1/pauseRequest", kServiceQos, {}, {}});
  REQUIRE(requests.Publish({{{5}, 1}, {}}));
  server.Serve([](const auto&) { return SetBool_Response(); });
  Subscriber<Envelope<SetBool_Response>> replies(pair.right,
                                                 {"rr/w1/pauseReply", kServiceQos, {}, {}});
  CHECK(replies.Take().empty());
  server.Take();
  CHECK(replies.Take().size() == 1);
}

struct ActionPair : TwoNodes {
  ActionServer<FollowPath> server{left, kFollowPath, "r1"};
  ActionClient<FollowPath> client{right, "/r1/follow_path"};

  void SendAndAccept(const GoalId& id) {
    REQUIRE(client.Send(id, {}));
    const auto offers = server.Take();
    REQUIRE(offers.size() == 1);
    CHECK(offers[0].id == id);
    REQUIRE(server.Accept(offers[0], {}));
    client.Turn();  // asks for the result
  }
};

TEST_CASE("a goal is accepted, reports, and ends with its result", "[action]") {
  ActionPair pair;
  pair.SendAndAccept(kFirstGoal);
  CHECK(pair.client.Turn().status == GoalStatus::kExecuting);
  pair.server.Take();
  FollowPath::Feedback feedback;
  feedback.distance_to_goal(2.5F);
  pair.server.SendFeedback(kSecondGoal, {});  // another client's goal
  pair.server.SendFeedback(kFirstGoal, feedback);
  REQUIRE(pair.client.Turn().feedback);
  CHECK(pair.client.Turn().feedback->distance_to_goal() == 2.5F);
  CHECK_FALSE(pair.client.Turn().result);
  FollowPath::Result result;
  result.error_code(7);
  pair.server.Finish(kFirstGoal, GoalStatus::kSucceeded, result);
  CHECK(pair.client.Turn().status == GoalStatus::kSucceeded);
  CHECK(pair.client.Turn().result->error_code() == 7);
}

TEST_CASE("a result is also there for those who ask after the end, unknown goals have none",
          "[action]") {
  ActionPair pair;
  REQUIRE(pair.client.Send(kFirstGoal, {}));
  REQUIRE(pair.server.Accept(pair.server.Take().at(0), {}));
  pair.server.Finish(kFirstGoal, GoalStatus::kAborted, {});
  pair.client.Turn();
  pair.server.Take();
  CHECK(pair.client.Turn().status == GoalStatus::kAborted);

  ServiceClient<FollowPath::GetResultRequest, FollowPath::GetResultResponse> stranger(
      pair.right, "/r1/follow_path/_action/get_result");
  stranger.Call({});
  pair.server.Take();
  CHECK(stranger.Take().at(0).response.status() == 0);
}

TEST_CASE("a rejected goal and a known id do not execute", "[action]") {
  ActionPair pair;
  REQUIRE(pair.client.Send(kFirstGoal, {}));
  pair.server.Reject(pair.server.Take().at(0));
  CHECK(pair.client.Turn().status == GoalStatus::kAborted);
  CHECK(pair.server.status(kFirstGoal) == GoalStatus::kUnknown);
  pair.SendAndAccept(kSecondGoal);
  REQUIRE(pair.client.Send(kSecondGoal, {}));
  CHECK_FALSE(pair.server.Accept(pair.server.Take().at(0), {}));
}

TEST_CASE("a goal is canceled when its client asks", "[action]") {
  ActionPair pair;
  pair.SendAndAccept(kFirstGoal);
  pair.client.Cancel();
  pair.server.Take();
  CHECK(pair.server.status(kFirstGoal) == GoalStatus::kCanceling);
  pair.server.Finish(kFirstGoal, GoalStatus::kCanceled, {});
  CHECK(pair.client.Turn().status == GoalStatus::kCanceled);
}

TEST_CASE("a goal that is canceled before its server accepts it is canceled", "[action]") {
  ActionPair pair;
  REQUIRE(pair.client.Send(kFirstGoal, {}));
  pair.client.Cancel();
  const auto offers = pair.server.Take();  // the request to cancel comes first
  REQUIRE(pair.server.Accept(offers.at(0), {}));
  pair.client.Turn();
  pair.server.Take();
  CHECK(pair.server.status(kFirstGoal) == GoalStatus::kCanceling);
}

builtin_interfaces::msg::Time At(std::int32_t second) {
  builtin_interfaces::msg::Time time;
  time.sec(second);
  return time;
}

TEST_CASE("a request to cancel means one goal, all, or those accepted until a time", "[action]") {
  struct Row {
    GoalId id;
    std::int32_t second;
    std::vector<GoalId> canceling;
    int code;
  };
  constexpr GoalId kEnded{3};
  constexpr GoalId kStranger{4};
  const Row row = GENERATE(values<Row>({{{}, 0, {kFirstGoal, kSecondGoal}, 0},
                                        {kSecondGoal, 0, {kSecondGoal}, 0},
                                        {{}, 15, {kFirstGoal}, 0},
                                        {kSecondGoal, 15, {kFirstGoal, kSecondGoal}, 0},
                                        {{}, 5, {}, 0},
                                        {kEnded, 0, {}, 3},
                                        {kStranger, 0, {}, 2}}));
  GoalTable goals;
  REQUIRE(goals.Add(kFirstGoal, At(10)));
  REQUIRE(goals.Add(kSecondGoal, At(20)));
  REQUIRE(goals.Add(kEnded, At(1)));
  goals.Set(kEnded, GoalStatus::kSucceeded);
  action_msgs::msg::GoalInfo request;
  request.goal_id(ToMessage(row.id));
  request.stamp(At(row.second));
  const auto response = goals.Cancel(request);
  std::vector<GoalId> canceling;
  for (const auto& info : response.goals_canceling()) {
    canceling.push_back(ToGoalId(info.goal_id()));
  }
  CHECK(canceling == row.canceling);
  CHECK(response.return_code() == row.code);
}

TEST_CASE("old ended goals are forgotten, open ones are not", "[action]") {
  GoalTable goals;
  REQUIRE(goals.Add(kFirstGoal, {}));
  for (std::size_t i = 0; i < 2 * GoalTable::kKept; ++i) {
    const GoalId id{9, static_cast<std::uint8_t>(i)};
    REQUIRE(goals.Add(id, {}));
    goals.Set(id, GoalStatus::kCanceled);
  }
  CHECK(goals.Report().status_list().size() == GoalTable::kKept);
  CHECK(goals.status(kFirstGoal) == GoalStatus::kExecuting);
}

}  // namespace
}  // namespace conav::bus
