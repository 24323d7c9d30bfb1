#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/publisher.h"
#include "common/bus/ros_graph.h"
#include "common/cli/cli.h"
#include "common/msg/convert.h"
#include "common/runtime/text.h"
#include "common/service/robot_state_topics.h"
#include "robot/conformance.h"

// conav-doctor: whether a robot on the bus keeps the contract of docs/robots.md, and whether conav
// suits the ROS 2 nodes there.
namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr const char* kProgram = "conav doctor";
constexpr auto kDiscovery = 2s;
constexpr auto kGraphPatience = 3s;  // as ros2 --spin-time 3

struct DoctorArguments {
  ConformanceOptions options;
  bus::ParticipantOptions bus;
  std::filesystem::path json;  // "-" = standard output; empty = none
};

/// The robot as the bus shows it.
class RobotOnBus final : public RobotUnderTest {
 public:
  RobotOnBus(bus::Participant& participant, const std::string& robot)
      : participant_(participant),
        state_(participant, robot),
        map_(participant, bus::kRobotMap, robot),
        camera_info_(participant, bus::kCameraInfo, robot),
        snapshot_(participant, bus::kSnapshot, robot),
        lease_(participant, bus::kPlannerLease),
        command_(participant, bus::kRobotCommand, robot),
        stop_(participant, bus::kStopOrder, robot),
        robot_(robot) {}

  const RobotReport& report() const override { return report_; }
  /// The planner process that holds the robot; empty if none said so.
  const std::string& holder() const { return holder_; }

  void Send(const RobotCommand& command) override { bus::Send(command_, ToMessage(command)); }
  void Send(const StopOrder& order) override { bus::Send(stop_, ToMessage(order)); }
  void SendMalformed(const RobotCommand& command) override {
    auto message = ToMessage(command);
    message.heading(std::numeric_limits<double>::quiet_NaN());
    bus::Send(command_, message);
  }

  bool WaitUntil(const std::function<bool()>& done, std::chrono::milliseconds patience) override {
    const auto deadline = steady_clock::now() + patience;
    Take();
    while (!done()) {
      const auto left = deadline - steady_clock::now();
      if (left <= 0s) return false;
      participant_.Wait(left);
      Take();
    }
    return true;
  }

 private:
  void Take() {
    for (auto& state : state_.TakeStamped()) {
      report_.maps_named.try_emplace(state.value.map_stamp, state.source);
      report_.states.push_back(state.value);
      report_.state = std::move(state.value);
    }
    for (auto& map : map_.TakeValidStamped(kToDomain)) {
      const bool first = report_.maps_published.empty();
      report_.maps_published.try_emplace(map.value.stamp, first ? bus::SourceTime{} : map.source);
      report_.map = std::move(map.value);
    }
    for (const auto& lens : camera_info_.TakeValid(kToDomain)) report_.lens = lens;
    for (auto& snapshot : snapshot_.TakeValid(kToDomain)) report_.snapshot = std::move(snapshot);
    for (const PlannerLease& lease : lease_.TakeValid(kToDomain)) {
      for (const auto& held : lease.holds) {
        if (held.robot == robot_ && !lease.leaving) holder_ = lease.node;
      }
    }
  }

  bus::Participant& participant_;
  RobotReport report_;
  RobotStateTopics state_;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> map_;
  bus::Subscriber<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot_;
  bus::Subscriber<conav_msgs::msg::PlannerLease> lease_;
  bus::Publisher<conav_msgs::msg::RobotCommand> command_;
  bus::Publisher<conav_msgs::msg::StopOrder> stop_;
  std::string robot_;
  std::string holder_;
};

std::string_view VerdictName(ClauseResult::Verdict verdict) {
  switch (verdict) {
    case ClauseResult::Verdict::kHolds:
      return "holds";
    case ClauseResult::Verdict::kBroken:
      return "BROKEN";
    case ClauseResult::Verdict::kNotChecked:
      return "not checked";
  }
  return "";
}

void Print(std::FILE* output, const ClauseResult& result) {
  fmt::print(output, "{:<12} {:<12} {}\n", VerdictName(result.verdict), result.name, result.clause);
  if (!result.seen.empty()) fmt::print(output, "{:<25} {}\n", "", result.seen);
  std::fflush(output);
}

nlohmann::ordered_json ToJson(const std::vector<ClauseResult>& results) {
  nlohmann::ordered_json clauses = nlohmann::ordered_json::array();
  for (const ClauseResult& result : results) {
    clauses.push_back({{"name", result.name},
                       {"clause", result.clause},
                       {"verdict", VerdictName(result.verdict)},
                       {"seen", result.seen}});
  }
  return {{"clauses", std::move(clauses)}};
}

int CheckRobot(DoctorArguments arguments) {
  arguments.bus.role = "doctor";
  bus::Participant participant("conav_doctor", arguments.bus);
  RobotOnBus robot(participant, arguments.options.robot);
  const bool found = robot.WaitUntil([&] { return robot.report().state.has_value(); }, kDiscovery);
  if (!found) {
    return Failed(kProgram, {ErrorCode::kNotFound,
                             fmt::format("nobody publishes /{}/state: start the robot, or choose "
                                         "--domain and --interface",
                                         arguments.options.robot)});
  }
  robot.WaitUntil([&] { return !robot.holder().empty(); }, arguments.options.quiet);
  if (!robot.holder().empty()) {
    return Failed(kProgram,
                  {ErrorCode::kRefused, fmt::format("planner {} drives {}: end it first",
                                                    robot.holder(), arguments.options.robot)});
  }
  std::FILE* output = arguments.json == "-" ? stderr : stdout;
  const auto results = CheckConformance(robot, arguments.options,
                                        [&](const ClauseResult& result) { Print(output, result); });
  const auto count = [&](ClauseResult::Verdict verdict) {
    return std::ranges::count(results, verdict, &ClauseResult::verdict);
  };
  const auto broken = count(ClauseResult::Verdict::kBroken);
  fmt::print(output, "{}: {} of {} clauses hold, {} broken, {} not checked\n",
             arguments.options.robot, count(ClauseResult::Verdict::kHolds), results.size(), broken,
             count(ClauseResult::Verdict::kNotChecked));
  const int written = ExitCode(kProgram, WriteJsonOutput(arguments.json, ToJson(results)));
  return broken > 0 ? 1 : written;
}

using bus::RosDistribution;

/// Names of the ROS 2 nodes in the domain, conav's own included, by the layout of their graph.
std::map<RosDistribution, std::set<std::string>> NodesByLayout(bus::Participant& participant) {
  std::map<RosDistribution, std::set<std::string>> nodes;
  bus::Subscriber<bus::RosDiscoveryInfo> infos(participant, bus::kRosDiscoveryInfo);
  const auto deadline = steady_clock::now() + kGraphPatience;
  while (steady_clock::now() < deadline) {
    participant.Wait(deadline - steady_clock::now());
    for (const auto& info : infos.Take()) {
      const auto found = bus::ParseRosDiscoveryInfo(info);
      if (found) nodes[found->layout].insert(found->names.begin(), found->names.end());
    }
  }
  return nodes;
}

/// 1 where nodes of both layouts meet, or would once conav runs with these settings.
int CheckRosNodes(bus::ParticipantOptions options) {
  const RosDistribution ours = bus::Resolve(options).ros_distribution.value();
  options.ros_distribution = RosDistribution::kNone;  // looks without being seen
  bus::Participant participant("conav_doctor", options);
  const auto nodes = NodesByLayout(participant);
  for (const auto& [layout, names] : nodes) {
    fmt::print("{:<8} {}\n", Name(layout), Join(names, " "));
  }
  if (nodes.empty()) {
    fmt::print(
        "no ROS 2 node says its name here. Nodes elsewhere: --domain, --interface, --peers\n");
    return 0;
  }
  const RosDistribution theirs = nodes.begin()->first;
  if (nodes.size() > 1) {
    fmt::print(
        "HARMFUL: nodes of both layouts share this domain. Either kind may take gigabytes of "
        "memory "
        "or find no nodes: put them into different domains (ROS_DOMAIN_ID), or start conav with "
        "--ros none\n");
    return 1;
  }
  if (ours == theirs) {
    fmt::print("conav suits them with the setting of this environment, --ros {}\n", Name(ours));
    return 0;
  }
  if (ours == RosDistribution::kNone) {
    fmt::print(
        "conav does them no harm; to show them its nodes, start it with --ros {0}, or set "
        "ROS_DISTRO={0}\n",
        Name(theirs));
    return 0;
  }
  fmt::print(
      "HARMFUL: with the setting of this environment conav would publish the layout of {}: "
      "start it with --ros {} or --ros none\n",
      Name(ours), Name(theirs));
  return 1;
}

void AddBusOptions(CLI::App& app, bus::ParticipantOptions& bus) {
  app.add_option("--domain", bus.domain_id, "DDS domain [CONAV_DOMAIN, else ROS_DOMAIN_ID, else 0]")
      ->check(Between(0, 232));
  app.add_option("--interface", bus.interface,
                 "Network interface [CONAV_INTERFACE, else the vendor's choice]");
  app.add_option("--peers", bus.peers, "Other hosts to look on");
}

constexpr const char* kAboutRos =
    R"(Checks on the live bus which ROS 2 nodes there are, and which --ros suits them.

ROS 2 up to Humble and from Iron on publish the graph of their nodes under one name in two layouts.
A process that reads the other one takes gigabytes of memory or finds no node at all, so conav
publishes none unless --ros or ROS_DISTRO says which one is right. This command looks for three
seconds and shows the nodes of each layout.

Exit codes: 0 conav started with this environment does no harm; 1 it would, or nodes of both kinds
are here; 2 wrong use.

Examples:
  conav doctor ros --domain 0
  ROS_DISTRO=humble conav doctor ros --interface eth0)";

constexpr const char* kAbout =
    R"(Checks on the live bus whether a robot keeps the contract of docs/robots.md.

Drives it a few metres to and fro in the free space of its map, sends it old, expired, malformed and
replaced commands, asks for one picture, stops and resumes it. Each clause holds or is broken; a
broken one says what the robot did instead. The robot needs free space around it, and no planner may
drive it; a simulator runs at its usual speed (sim.speed: 1). It stands afterwards, and planners take
it over under a higher lease epoch.

Exit codes: 0 no clause is broken; 1 one is, or there is no such robot; 2 wrong use.

Examples:
  conav up sim --config deploy/config/sim.yaml      in another terminal: a simulated robot
  conav doctor robot r1
  conav doctor robot r1 --domain 7 --step 1.5 --json report.json)";

}  // namespace
}  // namespace conav::robot

int main(int argc, char** argv) {
  CLI::App app("Checks parts of a running system", "conav doctor");
  app.require_subcommand(1);
  conav::robot::DoctorArguments arguments;
  CLI::App& robot = *app.add_subcommand("robot", conav::robot::kAbout);
  robot.add_option("robot", arguments.options.robot, "Its name, as in /r1/state")
      ->required()
      ->type_name("ROBOT");
  robot
      .add_option("--step", arguments.options.step_m,
                  "Length of its drives in metres [a cell of its map, at least 0.5]")
      ->check(conav::Between(0.1, 1000.0));
  conav::robot::AddBusOptions(robot, arguments.bus);
  robot.add_option("--json", arguments.json, "Write the results, or -");
  CLI::App& ros = *app.add_subcommand("ros", conav::robot::kAboutRos);
  conav::robot::AddBusOptions(ros, arguments.bus);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  if (ros.parsed()) return conav::robot::CheckRosNodes(arguments.bus);
  const int code = conav::CheckFiles(conav::robot::kProgram, {}, {{"--json", arguments.json}});
  return code != 0 ? code : conav::robot::CheckRobot(arguments);
}
