// Planner services that share robots, over real DDS. The test plays simulator and operator.
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <list>
#include <thread>

#include "common/bus/publisher.h"
#include "common/msg/convert.h"
#include "planner/planner_service.h"
#include "support/test_domain.h"

using namespace conav;
using namespace std::chrono_literals;

namespace {

bus::ParticipantOptions BusOptions(const std::string& vendor) {
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(vendor).value();
  options.domain_id = test::TestDomain();
  options.interface = "lo";
  return options;
}

planner::PlannerConfig Config(const std::string& name) {
  planner::PlannerConfig config;
  config.name = name;
  config.robots = {"w1/r1", "w1/r2"};
  config.perception = "embedded";
  config.perception_model = PerceptionModelKind::kGlpf;
  config.method = MethodKind::kInstruction;
  config.search.options.iterations = 100;
  return config;
}

/// One planner process's inside.
class Planner {
 public:
  Planner(const planner::PlannerConfig& config, const std::string& vendor)
      : participant_(config.name, BusOptions(vendor)), service_(participant_, config, clock_) {
    thread_ = std::thread([this] { service_.Run(stop_); });
  }
  ~Planner() {
    stop_.RequestStop();
    participant_.Wake();
    thread_.join();
  }

 private:
  bus::Participant participant_;
  SteadyClock clock_;
  planner::PlannerService service_;
  StopToken stop_;
  std::thread thread_;
};

/// Many times around the ring, starting with the cell after `start`.
std::vector<Cell> Rounds(Cell start) {
  std::vector<Cell> round;
  for (int column = 1; column < 5; ++column) round.push_back({1, column});
  for (int row = 1; row < 3; ++row) round.push_back({row, 5});
  for (int column = 5; column > 1; --column) round.push_back({3, column});
  for (int row = 3; row > 1; --row) round.push_back({row, 1});
  std::rotate(round.begin(), std::find(round.begin(), round.end(), start), round.end());
  std::vector<Cell> path;
  for (int i = 0; i < 500; ++i) path.insert(path.end(), round.begin(), round.end());
  return path;
}

/// A ring of free cells around a block; belief and map of the robots are the test's to choose.
OccupancyGrid Ring() {
  OccupancyGrid map(5, 7, Occupancy::kOccupied);
  for (const Cell cell : Rounds({1, 1})) map[cell] = Occupancy::kFree;
  return map;
}

/// Robots that carry out commands at once and refuse older epochs, as the sim does.
class Robots {
 public:
  explicit Robots(const std::string& vendor) : participant_("robots", BusOptions(vendor)) {
    Add("r1", {1, 1});
    Add("r2", {3, 5});
  }

  void PublishAll(const BeliefGrid& belief) {
    bus::Send(beliefs_, ToMessage(Belief{.world = "w1", .wall_probability = belief}));
    sensor_msgs::msg::CameraInfo camera;
    camera.width(320);
    camera.height(192);
    camera.k({114.4, 0.0, 160.0, 0.0, 114.4, 96.0, 0.0, 0.0, 1.0});
    for (Robot& robot : robots_) {
      bus::Send(robot.camera_info, camera);
      Guide(robot);
      bus::Send(robot.map, ToMessage(MapUpdate{{}, 2.0, Ring()}));
      bus::Send(robot.states, ToMessage(robot.state));
    }
  }

  /// Takes commands and announcements until `done`; false when that took too long.
  bool RunUntil(const std::function<bool()>& done) {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (!done()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      participant_.Wait(20ms);
      for (Robot& robot : robots_) {
        for (const RobotCommand& command : robot.commands.TakeValid(kConvert)) Do(robot, command);
      }
      for (PlannerLease& lease : leases_.TakeValid(kConvert)) said_[lease.node] = lease;
    }
    return true;
  }

  /// Whether planner `node` says that it holds `count` robots, and each has been commanded by it.
  bool Drives(const std::string& node, std::size_t count) {
    const auto said = said_.find(node);
    if (said == said_.end() || said->second.holds.size() != count) return false;
    return std::all_of(said->second.holds.begin(), said->second.holds.end(),
                       [&](const PlannerLease::Held& held) {
                         return Of(held.robot).state.lease_epoch == held.lease_epoch;
                       });
  }

  const RobotState& state(const std::string& robot) { return Of(robot).state; }
  /// Commands under an epoch that was older than the robot's.
  int stale_commands() const { return stale_commands_; }

 private:
  static constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

  struct Robot {
    Robot(bus::Participant& participant, const std::string& name)
        : states(participant, bus::kRobotState, name),
          map(participant, bus::kRobotMap, name),
          camera_info(participant, bus::kCameraInfo, name),
          guidance(participant, bus::kGuidance, name),
          commands(participant, bus::kRobotCommand, name) {}

    bus::Publisher<conav_msgs::msg::RobotState> states;
    bus::Publisher<nav_msgs::msg::OccupancyGrid> map;
    bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info;
    bus::Publisher<conav_msgs::msg::Guidance> guidance;
    bus::Subscriber<conav_msgs::msg::RobotCommand> commands;
    RobotState state;
    std::uint64_t guidances = 0;
  };

  void Add(const std::string& name, Cell start) {
    Robot& robot = robots_.emplace_back(participant_, name);
    robot.state.world = "w1";
    robot.state.robot = name;
    robot.state.cell = start;
    robot.state.path = {start};
    robot.state.goals_left = {{0, 0}};  // which nobody reaches
    robot.state.goals_total = 1;
  }

  Robot& Of(const std::string& name) {
    return *std::find_if(robots_.begin(), robots_.end(),
                         [&](const Robot& robot) { return robot.state.robot == name; });
  }

  void Guide(Robot& robot) {
    Guidance guidance;
    guidance.world = "w1";
    guidance.robot = robot.state.robot;
    guidance.revision = ++robot.guidances;
    guidance.path = Rounds(robot.state.cell);
    guidance.given_by = "test";
    guidance.valid_until = SimTime{} + std::chrono::hours(10);
    bus::Send(robot.guidance, ToMessage(guidance));
  }

  void Do(Robot& robot, const RobotCommand& command) {
    RobotState& state = robot.state;
    if (command.lease_epoch < state.lease_epoch) ++stale_commands_;
    const bool old = command.lease_epoch == state.lease_epoch &&
                     command.sequence_number <= state.command_sequence_number;
    if (command.lease_epoch < state.lease_epoch || old) return;
    state.stamp = state.stamp + 250ms;
    state.lease_epoch = command.lease_epoch;
    state.command_sequence_number = command.sequence_number;
    state.command_outcome = CommandOutcome::kDone;
    const bool taken = std::any_of(robots_.begin(), robots_.end(), [&](const Robot& other) {
      return other.state.cell == command.target;
    });
    if (taken) {
      state.command_outcome = CommandOutcome::kOccupied;
    } else {
      state.cell = command.target;
      state.path.push_back(state.cell);
    }
    bus::Send(robot.states, ToMessage(state));
  }

  bus::Participant participant_;
  bus::Publisher<conav_msgs::msg::BeliefMap> beliefs_{participant_, bus::kBelief, "w1"};
  bus::Subscriber<conav_msgs::msg::PlannerLease> leases_{participant_, bus::kPlannerLease};
  std::list<Robot> robots_;
  std::map<std::string, PlannerLease> said_;  // by node
  int stale_commands_ = 0;
};

BeliefGrid Truth() {
  BeliefGrid belief(5, 7, 1.0F);
  for (const Cell cell : Rounds({1, 1})) belief[cell] = 0.0F;
  return belief;
}

}  // namespace

TEST_CASE("planners come and go and hand the robots over", "[planner][integration][lease]") {
  const auto [ours, first_vendor, second_vendor] = GENERATE(
      table<std::string, std::string, std::string>({{"cyclonedds", "cyclonedds", "cyclonedds"},
                                                    {"fastdds", "fastdds", "fastdds"},
                                                    {"cyclonedds", "fastdds", "cyclonedds"}}));
  CAPTURE(first_vendor, second_vendor);
  Robots robots(ours);
  robots.PublishAll(Truth());
  std::optional<Planner> first;
  first.emplace(Config("first"), first_vendor);
  REQUIRE(robots.RunUntil([&] { return robots.Drives("first", 2); }));
  // A second one comes: one robot each.
  std::optional<Planner> second;
  second.emplace(Config("second"), second_vendor);
  REQUIRE(robots.RunUntil([&] { return robots.Drives("first", 1) && robots.Drives("second", 1); }));
  const auto commands = robots.state("r1").command_sequence_number;
  // The first one goes: the second has both.
  first.reset();
  REQUIRE(robots.RunUntil([&] { return robots.Drives("second", 2); }));
  CHECK(robots.state("r1").command_sequence_number >= commands);
  CHECK(robots.state("r1").lease_epoch + robots.state("r2").lease_epoch == 4);
  CHECK(robots.stale_commands() == 0);
}
