// ROS 2 services and actions over both vendors.
#include <catch2/catch.hpp>

#include "common/bus/action.h"
#include "support/loopback.h"
#include "support/test_messages.h"

namespace conav::test {
namespace {

using bus::FollowPath;
using bus::GoalStatus;
using std_srvs::srv::SetBool_Request;
using std_srvs::srv::SetBool_Response;

struct TwoNodes {
  std::string vendor = GENERATE("cyclonedds", "fastdds");
  bus::Participant left{"left", OnLoopback(vendor)};
  bus::Participant right{"right", OnLoopback(vendor)};
};

TEST_CASE("each client of a service gets its own replies, on both vendors", "[service]") {
  TwoNodes nodes;
  CAPTURE(nodes.vendor);
  using Client = bus::ServiceClient<SetBool_Request, SetBool_Response>;
  Client client(nodes.right, "/w1/pause");
  Client other(nodes.right, "/w1/pause");
  CHECK_FALSE(client.IsReady());
  bus::ServiceServer server(nodes.left, bus::kPauseService, "w1");
  REQUIRE(WaitUntil(nodes.right, [&] {
    const bool ready = other.IsReady();
    return client.IsReady() && ready;
  }));
  SetBool_Request yes;
  yes.data(true);
  const auto asked = client.Call(yes);
  const auto asked_other = other.Call({});
  REQUIRE((asked && asked_other));
  std::vector<Client::Reply> replies;
  std::vector<Client::Reply> other_replies;
  REQUIRE(WaitUntil(nodes.left, [&] {
    server.Serve([](const SetBool_Request& request) {
      SetBool_Response response;
      response.success(request.data());
      response.message("asked");
      return response;
    });
    for (const auto& reply : client.Take()) replies.push_back(reply);
    for (const auto& reply : other.Take()) other_replies.push_back(reply);
    return !replies.empty() && !other_replies.empty();
  }));
  REQUIRE(replies.size() == 1);
  REQUIRE(other_replies.size() == 1);
  CHECK(replies[0].number == *asked);
  CHECK(replies[0].response.success());
  CHECK(replies[0].response.message() == "asked");
  CHECK(other_replies[0].number == *asked_other);
  CHECK_FALSE(other_replies[0].response.success());
}

TEST_CASE("a goal goes from request to result, and is canceled, on both vendors", "[action]") {
  TwoNodes nodes;
  CAPTURE(nodes.vendor);
  bus::ActionServer server(nodes.left, bus::kFollowPath, "r1");
  bus::ActionClient<FollowPath> client(nodes.right, "/r1/follow_path");
  REQUIRE(WaitUntil(nodes.right, [&] { return client.IsReady(); }));
  const auto offered = [&](const bus::GoalId& id, FollowPath::Goal goal) {
    REQUIRE(client.Send(id, std::move(goal)));
    std::vector<bus::ActionServer<FollowPath>::Offer> offers;
    REQUIRE(WaitUntil(nodes.left, [&] {
      for (auto& offer : server.Take()) offers.push_back(offer);
      return !offers.empty();
    }));
    return offers.at(0);
  };
  const auto reaches = [&](GoalStatus status) {
    return WaitUntil(nodes.right, [&] {
      server.Take();
      return client.Turn().status == status;
    });
  };
  const bus::GoalId first{1, 2, 3};
  FollowPath::Goal goal;
  goal.path().poses().resize(300);
  const auto offer = offered(first, goal);
  CHECK(offer.id == first);
  CHECK(offer.goal.path().poses().size() == 300);
  REQUIRE(server.Accept(offer, {}));
  REQUIRE(reaches(GoalStatus::kExecuting));
  FollowPath::Feedback feedback;
  feedback.speed(0.5F);
  server.SendFeedback(first, feedback);
  REQUIRE(WaitUntil(nodes.right, [&] { return client.Turn().feedback.has_value(); }));
  FollowPath::Result result;
  result.error_code(7);
  server.Finish(first, GoalStatus::kAborted, result);
  REQUIRE(reaches(GoalStatus::kAborted));
  CHECK(client.Turn().result->error_code() == 7);

  const bus::GoalId second{4};
  REQUIRE(server.Accept(offered(second, {}), {}));
  REQUIRE(reaches(GoalStatus::kExecuting));
  client.Cancel();
  REQUIRE(WaitUntil(nodes.left, [&] {
    server.Take();
    return server.status(second) == GoalStatus::kCanceling;
  }));
  server.Finish(second, GoalStatus::kCanceled, {});
  CHECK(reaches(GoalStatus::kCanceled));
}

}  // namespace
}  // namespace conav::test
