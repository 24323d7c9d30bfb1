#include <fnmatch.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/runtime/result.h"
#include "keystore/keystore.h"

namespace conav::keystore {
namespace {

bool Matches(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::ranges::any_of(patterns, [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
  });
}

bool MayPublish(const Grant& grant, const std::string& topic) {
  return !Matches(grant.never_publish, topic) && Matches(grant.publish, topic);
}
bool MaySubscribe(const Grant& grant, const std::string& topic) {
  return !Matches(grant.never_subscribe, topic) && Matches(grant.subscribe, topic);
}

TEST_CASE("each program may do what the tables of topics and services say, and nothing else",
          "[keystore]") {
  struct Row {
    const char* role;
    std::vector<std::string> robots;
    const char* topic;
    bool publish;
    bool subscribe;
  };
  const Row row = GENERATE(
      Row{"sim", {}, "rt/r1/state", true, true}, Row{"sim", {}, "rt/r1/command", false, true},
      Row{"sim", {}, "rt/r1/guidance", false, false}, Row{"sim", {}, "rt/r1/map", true, false},
      Row{"sim", {}, "rt/w1/belief/map", false, true}, Row{"sim", {}, "rt/clock", true, true},
      Row{"sim", {}, "rr/w1/pauseReply", true, false},
      Row{"sim", {}, "rq/w1/pauseRequest", false, true},
      Row{"sim", {}, "rr/r1/stopReply", false, false},
      Row{"driver", {"r1"}, "rt/r1/state", true, true},
      Row{"driver", {"r1"}, "rt/r2/state", false, true},
      Row{"driver", {"r1"}, "rt/r1/command", false, true},
      Row{"driver", {"r1"}, "rt/r2/command", false, false},
      Row{"driver", {"r1"}, "rt/r2/stop", false, false},
      Row{"driver", {"r1"}, "rt/clock", false, true},
      Row{"driver", {"r1"}, "rt/w1/truth", false, false},
      Row{"planner", {}, "rt/r1/command", true, false},
      Row{"planner", {}, "rt/r1/stop", false, true},
      Row{"planner", {"r1"}, "rt/r2/command", false, false},
      Row{"planner", {}, "rt/conav/operator/request", false, false},
      Row{"planner", {}, "rt/conav/perception/request", true, false},
      Row{"planner", {}, "rt/r1/follow_path/_action/feedback", true, false},
      Row{"nhpm", {}, "rt/conav/perception/request", false, true},
      Row{"nhpm", {}, "rt/conav/perception/reply", true, false},
      Row{"nhpm", {}, "rt/r1/command", false, false}, Row{"operator", {}, "rt/r1/stop", true, true},
      Row{"operator", {}, "rt/r1/command", false, true},
      Row{"operator", {}, "rr/r1/stopReply", true, false},
      Row{"simulated_operator", {}, "rt/conav/operator/request", true, false},
      Row{"simulated_operator", {}, "rt/r1/stop", false, true},
      Row{"recorder", {}, "rt/r1/command", false, true},
      Row{"recorder", {}, "rt/w1/truth", false, true},
      Row{"recorder", {}, "rt/conav/operator/request", false, true},
      Row{"launcher", {}, "rt/r1/goal_pose", false, true},
      Row{"tools", {}, "rt/r1/goal_pose", true, true},
      Row{"tools", {}, "rt/r1/command", false, true},
      Row{"doctor", {}, "rt/r1/command", true, true}, Row{"doctor", {}, "rt/r1/stop", true, true},
      Row{"doctor", {}, "rt/r1/state", false, true},
      Row{"doctor", {}, "rt/conav/operator/request", false, true},
      Row{"doctor", {"r2"}, "rt/r1/command", false, false},
      Row{"tools", {}, "rq/r1/stopRequest", true, true},
      Row{"tools", {}, "rr/r1/stopReply", false, true},
      Row{"nhpm", {}, "ros_discovery_info", true, true}, Row{"nhpm", {}, "rt/other", false, false});
  CAPTURE(row.role, row.robots, row.topic);
  const Grant grant = GrantOf(row.role, {row.robots, {}});
  CHECK(MayPublish(grant, row.topic) == row.publish);
  CHECK(MaySubscribe(grant, row.topic) == row.subscribe);
}

TEST_CASE("a driver may use the topics and actions of its robot that it is given", "[keystore]") {
  const Grant grant = GrantOf("driver", {{"r1"}, {"/scan", "/nav/go"}});
  for (const char* topic :
       {"rt/scan", "rt/nav/go/_action/status", "rq/nav/go/_action/send_goalRequest"}) {
    CAPTURE(topic);
    CHECK(MayPublish(grant, topic));
    CHECK(MaySubscribe(grant, topic));
  }
  CHECK_FALSE(MayPublish(grant, "rt/scan2"));
}

TEST_CASE("the words of the table of topics are programs", "[keystore]") {
  using Roles = std::vector<std::string_view>;
  CHECK(RolesIn("sim (episode) or operator (field)") == Roles{"sim", "operator"});
  CHECK(RolesIn("sim of the first world") == Roles{"sim"});
  CHECK(RolesIn("operator, driver; planner in the mapping task") ==
        Roles{"operator", "driver", "planner"});
  CHECK(RolesIn("all services").size() == kRoles.size());
  CHECK_THROWS_AS(RolesIn("somebody"), StartupError);
}

}  // namespace
}  // namespace conav::keystore
