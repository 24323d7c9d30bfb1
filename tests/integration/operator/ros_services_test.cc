// The operator's ROS 2 services.
#include "operator/supervision/ros_services.h"

#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "integration/operator/operator_bench.h"

namespace conav::operators {
namespace {

struct ServiceBench : OperatorBench {
  using TriggerClient =
      bus::ServiceClient<std_srvs::srv::Trigger_Request, std_srvs::srv::Trigger_Response>;

  std_srvs::srv::Trigger_Response Call(const std::string& name) {
    TriggerClient caller(client_participant, name);
    REQUIRE(caller.Call({}));
    service.Step();
    const auto replies = caller.Take();
    REQUIRE(replies.size() == 1);
    return replies[0].response;
  }
  bool Save(const std::string& name) {
    bus::ServiceClient<nav2_msgs::srv::SaveMap_Request, nav2_msgs::srv::SaveMap_Response> caller(
        client_participant, "/w1/save_map");
    nav2_msgs::srv::SaveMap_Request request;
    request.map_url(name);
    REQUIRE(caller.Call(std::move(request)));
    service.Step();
    return caller.Take().at(0).response.result();
  }
};

TEST_CASE("a ROS 2 program stops a robot, and resumes it unless a person has control",
          "[operator][service]") {
  ServiceBench bench;
  bus::Subscriber<conav_msgs::msg::StopOrder> orders(bench.client_participant, bus::kStopOrder,
                                                     "r1");
  bench.sim.Begin();
  bench.service.Step();
  CHECK(bench.Call("/r1/stop").success());
  // As robots read it.
  const auto taken = [&] { return orders.TakeValid([](const auto& m) { return ToDomain(m); }); };
  auto order = taken();
  REQUIRE(order.size() == 1);
  CHECK(order[0].stopped);
  CHECK(order[0].given_by == "ros2");
  CHECK(bench.Call("/r1/resume").success());
  order = taken();
  REQUIRE(order.size() == 1);
  CHECK_FALSE(order[0].stopped);

  REQUIRE(bench.Ask(TakeControlRequest{{"r1"}, ""}).accepted);
  CHECK(bench.Call("/r1/stop").success());  // anybody may
  const auto refused = bench.Call("/r1/resume");
  CHECK_FALSE(refused.success());
  CHECK_THAT(refused.message(), Catch::Contains("anna"));
}

TEST_CASE("the operator's map is saved as map_server reads it", "[operator][service]") {
  ServiceBench bench;
  CHECK_FALSE(bench.Save("early"));  // no map yet
  bench.sim.Begin();
  bench.service.Step();
  CHECK(bench.Save("office"));
  const auto yaml = ReadFile(bench.folder / "office.yaml");
  REQUIRE(yaml);
  CHECK(*yaml ==
        "image: office.pgm\nmode: trinary\nresolution: 1.5\norigin: [-4.5, -3.75, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n");
  const auto pgm = ReadFile(bench.folder / "office.pgm");
  REQUIRE(pgm);
  const std::string header = "P5\n6 5\n255\n";
  REQUIRE(pgm->size() == header.size() + 30);
  CHECK(pgm->starts_with(header));
  const std::string row = pgm->substr(header.size() + 12, 6);  // "# ## #"
  CHECK(row == std::string("\x00\xfe\x00\x00\xfe\x00", 6));

  CHECK_FALSE(bench.Save("../elsewhere"));
  CHECK_FALSE(bench.Save(""));
  CHECK_FALSE(ReadFile(bench.folder / "../elsewhere.yaml"));
}

}  // namespace
}  // namespace conav::operators
