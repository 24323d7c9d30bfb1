#include "launcher/demo_plan.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>

#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "operator/simulated/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "support/scoped_variable.h"

using namespace conav;
using namespace conav::launcher;
namespace fs = std::filesystem;

namespace {

struct TemporaryRun {
  fs::path parent = fs::temp_directory_path() / ("conav_demo_plan_" + std::to_string(getpid()));
  RunFolder folder{parent, std::chrono::system_clock::time_point{}, 1};
  ~TemporaryRun() { fs::remove_all(parent); }
};

std::map<std::string, std::string> Plan(const DemoOptions& options, const TemporaryRun& run) {
  std::map<std::string, std::string> configs;
  const Episode episode = MakeEpisode(options.robots, options.worlds);
  for (const auto& process : PlanDemo(options, 42, episode, run.folder)) {
    configs[process.name] = process.config;
  }
  return configs;
}

template <class Config>
Config Read(const std::string& yaml, const std::string& section) {
  Config config;
  ReadConfig(YAML::Load(yaml)[section]["ros__parameters"], section, config);
  return config;
}

template <class Config>
Config ReadExample(const std::string& section) {
  Config config;
  const std::string file = std::string(CONAV_SOURCE_DIR) + "/deploy/config/" + section + ".yaml";
  ReadConfig(LoadParameters(file, section), section, config);
  return config;
}

}  // namespace

TEST_CASE("each process of a demo gets a configuration that its own struct reads back",
          "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.robots = 2;
  options.seed = 7;
  options.dds = "sim=fastdds,planner=cyclonedds";
  options.headless = true;
  options.peers = {"10.0.0.1"};
  const auto configs = Plan(options, run);
  REQUIRE(configs.size() == 6);
  const auto sim = Read<sim::SimConfig>(configs.at("sim"), "sim");
  CHECK(sim.robots == std::vector<std::string>{"r1", "r2"});
  CHECK(sim.seed == 7);
  CHECK(sim.speed == 0.0);
  CHECK_FALSE(sim.camera.stream);
  CHECK(sim.bus.vendor == "fastdds");
  CHECK(sim.bus.domain_id == 42);
  CHECK(sim.bus.interface == "lo");
  CHECK(sim.bus.peers == std::vector<std::string>{"10.0.0.1"});
  const auto planner = Read<planner::PlannerConfig>(configs.at("planner"), "planner");
  CHECK(planner.robots == std::vector<std::string>{"w1/r1", "w1/r2"});
  CHECK(planner.bus.vendor == "cyclonedds");
  const auto operators = Read<operators::OperatorConfig>(configs.at("operator"), "operator");
  CHECK(operators.database == (run.folder.state() / "operator.db").string());
  CHECK(operators.recording.file == (run.folder.path() / "segments.pb.zst").string());
  CHECK(operators.recording.origin == "simulated");
  CHECK(operators.recording.session == run.folder.path().filename().string());
  CHECK(operators.recording.mazes == std::vector<std::string>{"w1=conav13@7"});
  CHECK(Read<operators::SimulatedOperatorConfig>(configs.at("simulated-operator"),
                                                 "simulated_operator")
            .seed == 7);
  CHECK(Read<nhpm::NhpmConfig>(configs.at("nhpm"), "nhpm").bus.domain_id == 42);
}

TEST_CASE("the world's seed and turn and the operator's person can be chosen by themselves",
          "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.seed = 7;
  options.maze_seed = 234;
  options.rotation_deg = 90;
  options.simulated_operator = "hasty";
  const auto configs = Plan(options, run);
  const auto sim = Read<sim::SimConfig>(configs.at("sim"), "sim");
  CHECK(sim.seed == 234);
  CHECK(sim.rotation_deg == 90);
  CHECK(Read<planner::PlannerConfig>(configs.at("planner"), "planner").seed == 7);
  const auto person = Read<operators::SimulatedOperatorConfig>(configs.at("simulated-operator"),
                                                               "simulated_operator");
  CHECK(person.seed == 7);
  CHECK(person.person.planner.horizon == "next_goal");
  CHECK(Read<operators::OperatorConfig>(configs.at("operator"), "operator").recording.mazes ==
        std::vector<std::string>{"w1=conav13 rotated 90@234"});
}

TEST_CASE("each world has a simulator with its own robots and seed", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.robots = 2;
  options.worlds = 2;
  options.method = "teleop";
  const auto configs = Plan(options, run);
  const auto second = Read<sim::SimConfig>(configs.at("sim-w2"), "sim");
  CHECK(second.world == "w2");
  CHECK(second.robots == std::vector<std::string>{"r3", "r4"});
  CHECK(second.seed == 2);
  CHECK(second.camera.stream);
  CHECK_FALSE(second.publish_clock);  // a domain has one /clock
  CHECK(Read<sim::SimConfig>(configs.at("sim-w1"), "sim").publish_clock);
  CHECK(Read<planner::PlannerConfig>(configs.at("planner"), "planner").robots.size() == 4);
}

TEST_CASE("maps, cell size and shared goals reach the simulator", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.map = "maps/truth.yaml";
  options.operator_map = "/plans/old.yaml";
  options.cell_size_m = 1.5;
  options.shared_goals = true;
  const auto sim = Read<sim::SimConfig>(Plan(options, run).at("sim"), "sim");
  CHECK(sim.map.yaml == (fs::current_path() / "maps/truth.yaml").string());
  CHECK(sim.map.operator_yaml == "/plans/old.yaml");
  CHECK(sim.map.cell_size_m == 1.5);
  CHECK(sim.shared_goals);
  const auto without = Read<sim::SimConfig>(Plan({}, run).at("sim"), "sim");
  CHECK(without.map.yaml.empty());
  CHECK(without.map.operator_yaml.empty());
  CHECK(without.map.cell_size_m == sim::SimConfig{}.map.cell_size_m);
  CHECK_FALSE(without.shared_goals);
}

TEST_CASE("what the environment says of the bus is written into every configuration",
          "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.interface = "";
  const test::ScopedVariable no_vendor("CONAV_DDS", nullptr);
  CHECK(Read<sim::SimConfig>(Plan(options, run).at("sim"), "sim").bus.vendor == "cyclonedds");
  const test::ScopedVariable vendor("CONAV_DDS", "fastdds");
  const test::ScopedVariable interface("CONAV_INTERFACE", "eth7");
  options.dds = "planner=cyclonedds";
  const auto configs = Plan(options, run);
  const auto sim = Read<sim::SimConfig>(configs.at("sim"), "sim");
  CHECK(sim.bus.vendor == "fastdds");
  CHECK(sim.bus.interface == "eth7");
  CHECK(Read<planner::PlannerConfig>(configs.at("planner"), "planner").bus.vendor == "cyclonedds");
}

TEST_CASE("model and weights reach the service and the planner", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.model = "nhpm";
  options.weights = "models/own.nhpm";
  options.x_source = "estimated";
  const auto configs = Plan(options, run);
  const std::string weights = (fs::current_path() / "models/own.nhpm").string();
  const auto service = Read<nhpm::NhpmConfig>(configs.at("nhpm"), "nhpm");
  CHECK(service.model == "nhpm");
  CHECK(service.weights == weights);
  const auto planner = Read<planner::PlannerConfig>(configs.at("planner"), "planner");
  CHECK(planner.perception_model == "nhpm");
  CHECK(planner.weights == weights);
  CHECK(planner.x_source == "estimated");
  options.weights.clear();
  CHECK(Read<nhpm::NhpmConfig>(Plan(options, run).at("nhpm"), "nhpm").weights ==
        nhpm::ShippedWeights().string());
}

TEST_CASE("a person and the folder of weights reach planner and service", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.person = "p07";
  options.person_weights = "people";
  const auto configs = Plan(options, run);
  CHECK(Read<planner::PlannerConfig>(configs.at("planner"), "planner").person == "p07");
  CHECK(Read<nhpm::NhpmConfig>(configs.at("nhpm"), "nhpm").person_weights ==
        (fs::current_path() / "people").string());
}

TEST_CASE("a planner with a model of its own needs no nhpm", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.perception = "embedded";
  const auto configs = Plan(options, run);
  CHECK(configs.size() == 5);
  CHECK_FALSE(configs.contains("nhpm"));
}

TEST_CASE("replicas of nhpm have names of their own", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.nhpm_replicas = 2;
  const auto configs = Plan(options, run);
  CHECK(configs.size() == 7);
  CHECK(Read<nhpm::NhpmConfig>(configs.at("nhpm-1"), "nhpm").name == "nhpm-1");
  CHECK(Read<nhpm::NhpmConfig>(configs.at("nhpm-2"), "nhpm").name == "nhpm-2");
}

TEST_CASE("a command is put before the service that it is meant for", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.run_with["sim"] = "ip netns exec a";
  const PlannedProcess sim{"sim-w1", "sim", ""};
  CHECK(CommandLine(sim, options, "/bin", run.folder) ==
        std::vector<std::string>{"ip", "netns", "exec", "a", "/bin/conav-sim", "--config",
                                 run.folder.config("sim-w1").string()});
  const PlannedProcess planner{"planner", "planner", ""};
  CHECK(CommandLine(planner, options, "/bin", run.folder).front() == "/bin/conav-planner");
}

TEST_CASE("the example configurations are what the services read", "[launcher][plan]") {
  CHECK(ReadExample<sim::SimConfig>("sim").world == "w1");
  CHECK(ReadExample<planner::PlannerConfig>("planner").method == "ig-mcts");
  CHECK(ReadExample<nhpm::NhpmConfig>("nhpm").model == kDefaultPerceptionModel);
  CHECK(ReadExample<operators::OperatorConfig>("operator").bus.interface == "lo");
  CHECK(ReadExample<operators::SimulatedOperatorConfig>("simulated_operator").seed == 1);
  CHECK(ReadExample<recorder::RecorderConfig>("recorder").file == "recording.mcap");
}

TEST_CASE("a run is recorded from its begin unless it shall not be", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.robots = 2;
  options.seed = 7;
  options.dds = "recorder=fastdds";
  const auto first = PlanDemo(options, 42, MakeEpisode(2, 1), run.folder).at(0);
  CHECK(first.name == kRecorderName);
  const auto config = Read<recorder::RecorderConfig>(first.config, "recorder");
  CHECK(config.file == (run.folder.path() / "recording.mcap").string());
  CHECK(config.robots == std::vector<std::string>{"w1/r1", "w1/r2"});
  CHECK(config.bus.vendor == "fastdds");
  CHECK_FALSE(config.streams);
  CHECK(config.facts.at("seed") == "7");
  CHECK(config.facts.at("world") == "conav13");
  options.streams = true;
  CHECK(Read<recorder::RecorderConfig>(Plan(options, run).at("recorder"), "recorder").streams);
  CHECK(Validate(options));
  options.recording = false;
  CHECK_FALSE(Plan(options, run).contains("recorder"));
  CHECK_FALSE(Validate(options));
}

TEST_CASE("several planners share all robots, under names of their own", "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  options.robots = 3;
  options.planners = 2;
  options.dds = "mixed";
  const auto configs = Plan(options, run);
  CHECK_FALSE(configs.contains("planner"));
  const auto first = Read<planner::PlannerConfig>(configs.at("planner-1"), "planner");
  const auto second = Read<planner::PlannerConfig>(configs.at("planner-2"), "planner");
  CHECK(first.decision_file != second.decision_file);  // both are read by conav explain
  CHECK(first.name == "planner-1");
  CHECK(second.name == "planner-2");
  CHECK(first.robots == second.robots);
  CHECK(first.robots.size() == 3);
  CHECK(first.lease.planners == 2);
  CHECK(first.bus.vendor != second.bus.vendor);
}

TEST_CASE("the planner is told who decides on pictures, by names that it knows",
          "[launcher][plan]") {
  const TemporaryRun run;
  DemoOptions options;
  for (const char* policy : planner::kCommunicationPolicies) {
    options.communication = policy;
    REQUIRE(Validate(options));
    const auto planner = Read<planner::PlannerConfig>(Plan(options, run).at("planner"), "planner");
    CHECK(planner.communication.policy == policy);
  }
}

TEST_CASE("pictures are streamed where a person steers or instructs", "[launcher][plan]") {
  const TemporaryRun run;
  for (const char* method : {"ig-mcts", "instruction", "teleop", "greedy"}) {
    DemoOptions options;
    options.method = method;
    const auto sim = Read<sim::SimConfig>(Plan(options, run).at("sim"), "sim");
    CHECK(sim.camera.stream == (options.method == "instruction" || options.method == "teleop"));
  }
}
