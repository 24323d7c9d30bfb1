#include "launcher/demo_plan.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>

#include "common/runtime/file.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "operator/simulated/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"
#include "support/test_weights.h"

namespace conav::launcher {
namespace {

namespace fs = std::filesystem;

/// A run's folder, the options of a demo, and what its processes get to read.
struct Run {
  std::map<std::string, std::string> Plan() const {
    std::map<std::string, std::string> configs;
    for (const auto& process : PlanDemo(options, 42, EpisodeOf(options), folder)) {
      configs[process.name] = process.config;
    }
    return configs;
  }
  /// Of process `name`; an own struct of the service reads it back.
  template <class Config>
  Config Read(const std::string& name, std::string section = "") const {
    if (section.empty()) section = name;
    Config config;
    ReadConfig(YAML::Load(Plan().at(name))[section]["ros__parameters"], section, config);
    return config;
  }
  sim::SimConfig Sim(const std::string& name = "sim") const {
    return Read<sim::SimConfig>(name, "sim");
  }
  planner::PlannerConfig Planner(const std::string& name = "planner") const {
    return Read<planner::PlannerConfig>(name, "planner");
  }
  nhpm::NhpmConfig Nhpm(const std::string& name = "nhpm") const {
    return Read<nhpm::NhpmConfig>(name, "nhpm");
  }
  operators::OperatorConfig Operator() const { return Read<operators::OperatorConfig>("operator"); }
  operators::SimulatedOperatorConfig Person() const {
    return Read<operators::SimulatedOperatorConfig>("simulated-operator", "simulated_operator");
  }

  test::TemporaryFolder parent;
  RunFolder folder{parent.path(), std::chrono::system_clock::time_point{}, 1};
  DemoOptions options;
};

template <class Config>
Config ReadExample(const std::string& section) {
  Config config;
  const std::string file = std::string(CONAV_SOURCE_DIR) + "/deploy/config/" + section + ".yaml";
  ReadConfig(LoadParameters(file, section), section, config);
  return config;
}

TEST_CASE("each process of a demo gets a configuration that its own struct reads back",
          "[launcher]") {
  Run run;
  run.options.robots = 2;
  run.options.seed = 7;
  run.options.dds = "sim=fastdds,planner=cyclonedds";
  run.options.headless = true;
  run.options.peers = {"10.0.0.1"};
  run.options.ros = bus::RosDistribution::kHumble;
  CHECK(run.Plan().size() == 6);
  const sim::SimConfig sim = run.Sim();
  CHECK(sim.robots == std::vector<std::string>{"r1", "r2"});
  CHECK(sim.seed == 7);
  CHECK(sim.speed == 0.0);
  CHECK(sim.bus.vendor == bus::Vendor::kFastDds);
  CHECK(sim.bus.domain_id == 42);
  CHECK(sim.bus.interface == "lo");
  CHECK(sim.bus.peers == std::vector<std::string>{"10.0.0.1"});
  CHECK(sim.bus.ros_distribution == bus::RosDistribution::kHumble);
  CHECK(run.Planner().robots == std::vector<std::string>{"w1/r1", "w1/r2"});
  CHECK(run.Planner().bus.vendor == bus::Vendor::kCycloneDds);
  const operators::OperatorConfig operators = run.Operator();
  CHECK(operators.database == (run.folder.state() / "operator.db").string());
  CHECK(operators.recording.file == (run.folder.path() / "segments.pb.zst").string());
  CHECK(operators.recording.origin == "simulated");
  CHECK(operators.recording.session == run.folder.path().filename().string());
  CHECK(operators.recording.mazes == std::vector<std::string>{"w1=conav13@7"});
  CHECK(run.Person().seed == 7);
  CHECK(run.Nhpm().bus.domain_id == 42);
}

TEST_CASE("each world has a simulator with its own robots and seed, which --maze-seed may choose",
          "[launcher]") {
  Run run;
  run.options.robots = 2;
  run.options.worlds = 2;
  run.options.seed = 7;
  run.options.maze_seed = 234;
  run.options.rotation_deg = 90;
  run.options.simulated_operator = "hasty";
  const sim::SimConfig second = run.Sim("sim-w2");
  CHECK(second.world == "w2");
  CHECK(second.robots == std::vector<std::string>{"r3", "r4"});
  CHECK(second.seed == 235);
  CHECK(second.rotation_deg == 90);
  CHECK_FALSE(second.publish_clock);  // a domain has one /clock
  CHECK(run.Sim("sim-w1").publish_clock);
  CHECK(run.Planner().robots.size() == 4);
  CHECK(run.Planner().seed == 7);
  CHECK(run.Person().seed == 7);
  CHECK(run.Person().person.planner.horizon == "next_goal");
  CHECK(run.Operator().recording.mazes[0] == "w1=conav13 rotated 90@234");
}

TEST_CASE("the environment's bus settings are written into every configuration", "[launcher]") {
  Run run;
  run.options.interface = "";
  const test::ScopedVariable no_vendor("CONAV_DDS", nullptr);
  CHECK(run.Sim().bus.vendor == bus::Vendor::kCycloneDds);
  const test::ScopedVariable vendor("CONAV_DDS", "fastdds");
  const test::ScopedVariable interface("CONAV_INTERFACE", "eth7");
  run.options.dds = "planner=cyclonedds";
  CHECK(run.Sim().bus.vendor == bus::Vendor::kFastDds);
  CHECK(run.Sim().bus.interface == "eth7");
  CHECK(run.Planner().bus.vendor == bus::Vendor::kCycloneDds);
}

TEST_CASE("a waterway has its own world, model and search", "[launcher]") {
  Run run;
  run.options.world = "waterway";
  CHECK(run.Sim().preset == "waterway");
  CHECK(run.Nhpm().model == PerceptionModelKind::kEncoderDecoder);
  CHECK(run.Planner().perception_model == PerceptionModelKind::kEncoderDecoder);
  CHECK(run.Planner().weights ==
        nhpm::ShippedWeights(PerceptionModelKind::kEncoderDecoder).string());
  CHECK(run.Planner().search.graph == planner::SearchGraph::kRegions);
  CHECK(run.Planner().search.options.reward.communication_cost == 60.0);
  run.options.model = PerceptionModelKind::kGlpf;
  CHECK(run.Planner().perception_model == PerceptionModelKind::kGlpf);
}

TEST_CASE("a scenario reaches the simulator, the planner and the person", "[launcher]") {
  Run run;
  run.options.headless = true;
  run.options.scenario = "seen-goals-wrong-25";
  CHECK(run.Sim().preset == "loop-free21");
  CHECK(run.Sim().corruption.wrong_share == 0.25);
  CHECK(run.Planner().goal_knowledge == planner::GoalKnowledge::kSeen);
  CHECK(run.Operator().recording.mazes ==
        std::vector<std::string>{fmt::format("w1=loop-free21@{}", run.options.world_seed())});
  CHECK(run.Plan().at("simulated-operator").find("next_goal") != std::string::npos);
  run.options.scenario = "closing-doors";
  CHECK(run.Sim().closing_doors == 2);
  run.options.scenario = "search";
  CHECK_FALSE(run.Sim().keeps_goals);
  CHECK(run.Plan().at("simulated-operator").find("marks_goals: true") != std::string::npos);
  CHECK(run.Operator().goals.to_find == 4);
  CHECK(run.Operator().goals.robots == std::vector<std::string>{"r1"});
  run.options.shared_goals = true;
  CHECK_THAT(CheckSearch(run.options).error().text, Catch::StartsWith("--scenario search: each"));
  run.options.shared_goals = false;
  CHECK(CheckSearch(run.options));
  run.options.method = MethodKind::kTeleop;
  CHECK_THAT(CheckSearch(run.options).error().text, Catch::Contains("--method teleop"));
}

TEST_CASE("model, weights, person, maps and goals reach the services", "[launcher]") {
  Run run;
  CHECK(run.Nhpm().weights == nhpm::ShippedWeights().string());
  run.options.model = PerceptionModelKind::kNhpm;
  run.options.weights = "models/own.nhpm";
  run.options.x_source = "estimated";
  run.options.person = "p07";
  run.options.person_weights = "people";
  const std::string weights = (fs::current_path() / "models/own.nhpm").string();
  CHECK(run.Nhpm().model == PerceptionModelKind::kNhpm);
  CHECK(run.Nhpm().weights == weights);
  CHECK(run.Nhpm().person_weights == (fs::current_path() / "people").string());
  CHECK(run.Planner().perception_model == PerceptionModelKind::kNhpm);
  CHECK(run.Planner().weights == weights);
  CHECK(run.Planner().x_source == "estimated");
  CHECK(run.Planner().person == "p07");
  run.options.map = "maps/truth.yaml";
  run.options.operator_map = "/plans/old.yaml";
  run.options.cell_size_m = 1.5;
  run.options.shared_goals = true;
  const sim::SimConfig sim = run.Sim();
  CHECK(sim.map.yaml == (fs::current_path() / "maps/truth.yaml").string());
  CHECK(sim.map.operator_yaml == "/plans/old.yaml");
  CHECK(sim.map.cell_size_m == 1.5);
  CHECK(sim.shared_goals);
}

TEST_CASE("robots of an own map follow the operator through what nobody has seen", "[launcher]") {
  Run run;
  CHECK(run.Planner().search.preset == "default");
  CHECK(run.Planner().search.off_guidance_steps == 1);
  run.options.map = "maps/truth.yaml";
  run.options.cell_size_m = 1.0;
  CHECK(run.Planner().search.preset == "building");
  CHECK(run.Planner().search.off_guidance_steps == 3);
  CHECK(run.Planner().search.believed_wall_steps == 10);
  CHECK(run.Planner().search.graph == planner::SearchGraph::kCells);
}

TEST_CASE("cells below 1 m and height maps are open terrain, with room for the robots",
          "[launcher]") {
  Run run;
  run.options.map = "maps/truth.yaml";
  CHECK_FALSE(run.Sim().map.open);
  CHECK(run.Planner().search.graph == planner::SearchGraph::kCells);
  run.options.cell_size_m = 0.1;
  run.options.robot_radius_m = 0.3;
  CHECK(run.Sim().map.open);
  CHECK(run.Sim().body.radius_m == 0.3);
  CHECK(run.Nhpm().model == PerceptionModelKind::kEncoderDecoder);
  planner::SearchConfig search = run.Planner().search;
  CHECK(search.graph == planner::SearchGraph::kRegions);
  CHECK(search.regions.clearance_cells == Approx(4.0));
  run.options.cell_size_m.reset();
  run.options.robot_radius_m.reset();
  run.options.map = "/maps/lake.png";
  run.options.water_level = 90.0;
  run.options.resolution_m = 0.5;
  const sim::SimConfig sim = run.Sim();
  CHECK(sim.map.yaml == "");
  CHECK(sim.map.height_map == "/maps/lake.png");
  CHECK(sim.map.water_level == 90.0);
  CHECK(sim.map.resolution_m == 0.5);
  search = run.Planner().search;
  CHECK(search.regions.clearance_cells == Approx(0.625));
  CHECK(search.regions.cells_per_seed == planner::RegionOptions{}.cells_per_seed);
}

TEST_CASE("a command is put before the service that it is meant for", "[launcher]") {
  Run run;
  run.options.run_with["sim"] = "ip netns exec a";
  CHECK(CommandLine({"sim-w1", "sim", ""}, run.options, "/bin", run.folder) ==
        std::vector<std::string>{"ip", "netns", "exec", "a", "/bin/conav-sim", "--config",
                                 run.folder.config("sim-w1").string()});
  CHECK(CommandLine({"planner", "planner", ""}, run.options, "/bin", run.folder).front() ==
        "/bin/conav-planner");
}

TEST_CASE("the example configurations are what the services read", "[launcher]") {
  CHECK(ReadExample<sim::SimConfig>("sim").world == "w1");
  CHECK(ReadExample<planner::PlannerConfig>("planner").method == MethodKind::kIgMcts);
  CHECK(ReadExample<nhpm::NhpmConfig>("nhpm").model == PerceptionModelKind::kNhpm);
  CHECK(ReadExample<operators::OperatorConfig>("operator").bus.interface == "lo");
  CHECK(ReadExample<operators::SimulatedOperatorConfig>("simulated_operator").seed == 1);
  CHECK(ReadExample<recorder::RecorderConfig>("recorder").file == "recording.mcap");
}

TEST_CASE("a run is recorded from its begin unless it is switched off", "[launcher]") {
  Run run;
  run.options.robots = 2;
  run.options.seed = 7;
  run.options.dds = "recorder=fastdds";
  CHECK(PlanDemo(run.options, 42, MakeEpisode(2, 1), run.folder).at(0).name == kRecorderName);
  const auto config = run.Read<recorder::RecorderConfig>("recorder");
  CHECK(config.file == (run.folder.path() / "recording.mcap").string());
  CHECK(config.robots == std::vector<std::string>{"w1/r1", "w1/r2"});
  CHECK(config.bus.vendor == bus::Vendor::kFastDds);
  CHECK_FALSE(config.streams);
  CHECK(config.facts.at("seed") == "7");
  CHECK(config.facts.at("world") == "conav13");
  run.options.streams = true;
  CHECK(run.Read<recorder::RecorderConfig>("recorder").streams);
  run.options.recording = false;
  CHECK_FALSE(run.Plan().contains("recorder"));
}

TEST_CASE("several planners share all robots, replicas have names of their own", "[launcher]") {
  Run run;
  run.options.robots = 3;
  run.options.planners = 2;
  run.options.dds = "mixed";
  CHECK_FALSE(run.Plan().contains("planner"));
  const planner::PlannerConfig first = run.Planner("planner-1");
  const planner::PlannerConfig second = run.Planner("planner-2");
  CHECK(first.decision_file != second.decision_file);  // both are read by conav explain
  CHECK(first.name == "planner-1");
  CHECK(second.name == "planner-2");
  CHECK(first.robots == second.robots);
  CHECK(first.robots.size() == 3);
  CHECK(first.lease.planners == 2);
  CHECK(first.bus.vendor != second.bus.vendor);
  run.options.planners = 1;
  run.options.nhpm_replicas = 2;
  CHECK(run.Plan().size() == 7);
  CHECK(run.Nhpm("nhpm-1").name == "nhpm-1");
  CHECK(run.Nhpm("nhpm-2").name == "nhpm-2");
  run.options.perception = "embedded";
  CHECK(run.Plan().size() == 5);
}

TEST_CASE("policies are known by name, pictures are streamed where a person steers or instructs",
          "[launcher]") {
  Run run;
  for (const char* policy : planner::kCommunicationPolicies) {
    run.options.communication = policy;
    REQUIRE(Validate(run.options));
    CHECK(run.Planner().communication.policy == policy);
  }
  for (const MethodKind method : kDemoMethods) {
    run.options.method = method;
    CHECK(run.Sim().camera.stream ==
          (method == MethodKind::kInstruction || method == MethodKind::kTeleop));
  }
}

TEST_CASE("a teleoperation speed scales the others up to the motors' limits, as the person knows",
          "[launcher]") {
  Run run;
  for (const auto& [speed, backward, turn] :
       {std::tuple(0.8, 0.4, 45.0), {1.2, 0.6, 67.5}, {2.0, 1.0, 73.0}}) {
    run.options.teleop_mps = speed;
    const sim::DriveConfig drive = run.Sim().drive;
    CHECK(drive.forward_mps == speed);
    CHECK(drive.backward_mps == Approx(backward));
    CHECK(drive.turn_deg_per_s == Approx(turn));
    CHECK(run.Person().person.steering.forward_m == Approx(speed / 4.0));
    CHECK(run.Person().person.steering.turn_deg == Approx(turn / 4.0));
  }
}

/// Why `check` refuses the options; "" when it does not.
std::string Refusal(Result<void> (*check)(const DemoOptions&), const DemoOptions& options) {
  const auto checked = check(options);
  return checked ? "" : checked.error().text;
}

TEST_CASE("a simulated operator is a kind by its name or the person of a file", "[launcher]") {
  CHECK(OperatorPerson("hasty").planner.horizon == "next_goal");
  CHECK(OperatorPerson("silent").silent);
  const test::TemporaryFolder folder;
  DemoOptions options;
  for (const std::string& kind : operators::OperatorKinds()) {
    options.simulated_operator = kind;
    CHECK(Refusal(CheckOperator, options).empty());
  }
  const auto write = [&](const std::string& person) {
    options.simulated_operator = (folder / "anna.yaml").string();
    REQUIRE(WriteFile(options.simulated_operator,
                      "simulated_operator:\n  ros__parameters:\n    person: " + person + "\n"));
  };
  write("{kind: hasty, reader: {edit_limit: 9}}");
  CHECK(Refusal(CheckOperator, options).empty());
  CHECK(OperatorPerson(options.simulated_operator).reader.edit_limit == 9);
  CHECK(OperatorPerson(options.simulated_operator).planner.horizon == "next_goal");
  write("{age: 30}");
  CHECK_THAT(Refusal(CheckOperator, options),
             Catch::StartsWith("--operator ") && Catch::Contains("'age'"));
  options.simulated_operator = "lazy";
  CHECK_THAT(Refusal(CheckOperator, options),
             Catch::StartsWith("--operator lazy") && Catch::Contains("careful, hasty"));
}

TEST_CASE("weights fit the run's maps, or are refused by name", "[launcher]") {
  const test::WeightsFolder folder;
  DemoOptions options;
  CHECK(Refusal(CheckWeights, options) == "");
  options.weights = folder.path() / "notes.nhpm";
  REQUIRE(WriteFile(options.weights, "no weights"));
  CHECK_THAT(Refusal(CheckWeights, options),
             Catch::StartsWith("--weights " + options.weights.string()));
  CHECK(WeightsChecksum(options).empty());
  options.weights = folder.Write("any", test::UntrainedNetwork(1));
  CHECK(Refusal(CheckWeights, options) == "");
  options.weights = folder.Write("bound", test::UntrainedNetwork(1, 13, 13));
  CHECK(Refusal(CheckWeights, options) == "");
  options.preset = "15x15";
  CHECK_THAT(Refusal(CheckWeights, options),
             Catch::Contains("13 x 13") && Catch::Contains("17 x 17"));
  options.preset = "unknown";
  CHECK(Refusal(CheckWeights, options) == "");  // CheckWorlds says it
}

TEST_CASE("the checksum is that of the weights that answer", "[launcher]") {
  const test::WeightsFolder folder;
  const nhpm::NetworkModel everybody = test::UntrainedNetwork(1);
  const nhpm::NetworkModel anna = test::UntrainedNetwork(2);
  DemoOptions options;
  options.weights = folder.Write("everybody", everybody);
  CHECK(WeightsChecksum(options) == nhpm::ChecksumOf(everybody));
  options.person = "anna";
  options.person_weights = folder.path();
  CHECK_THAT(Refusal(CheckWeights, options), Catch::StartsWith("--person-weights "));
  folder.Write("anna", anna);
  CHECK(Refusal(CheckWeights, options) == "");
  CHECK(WeightsChecksum(options) == nhpm::ChecksumOf(anna));
  options.model = PerceptionModelKind::kGlpf;
  CHECK(WeightsChecksum(options).empty());
}

TEST_CASE("every world of a run has room for its robots, or is refused by option and seed",
          "[launcher]") {
  const auto refusal = [](int robots, int worlds, bool shared = false) {
    DemoOptions options;
    options.robots = robots;
    options.worlds = worlds;
    options.shared_goals = shared;
    options.maze_seed = 1;
    return Refusal(CheckWorlds, options);
  };
  CHECK(refusal(1, 1) == "");
  CHECK(refusal(8, 3) == "");
  CHECK(refusal(18, 1) == "");
  CHECK(refusal(24, 1, true) == "");
  CHECK_THAT(refusal(24, 1), Catch::Contains("--robots 24") && Catch::Contains("seed 1 ") &&
                                 Catch::Contains("room for 18"));
  CHECK_THAT(refusal(18, 16), Catch::Contains("--robots 18: the world of seed "));
}

TEST_CASE("a preset or map that is none is refused by its name", "[launcher]") {
  const test::TemporaryFolder folder;
  DemoOptions options;
  options.preset = "nope";
  CHECK_THAT(Refusal(CheckWorlds, options),
             Catch::StartsWith("--preset nope") && Catch::Contains("conav13_inner"));
  options = {};
  options.map = folder / "plan.yaml";
  REQUIRE(WriteFile(options.map, "hello"));
  CHECK_THAT(Refusal(CheckWorlds, options), Catch::StartsWith(options.map.string()));
  options.map = folder / "lake.png";
  REQUIRE(WriteFile(options.map, "hello"));
  CHECK_THAT(Refusal(CheckWorlds, options), Catch::StartsWith(options.map.string()));
}

TEST_CASE("a building too small for its robots is refused with what would do", "[launcher]") {
  DemoOptions options;
  options.map = std::string(CONAV_SOURCE_DIR) + "/tests/buildings/office.yaml";
  options.cell_size_m = 0.5;
  options.robots = 4;
  options.robot_radius_m = 2.0;  // fits into single rooms
  CHECK_THAT(Refusal(CheckWorlds, options), Catch::Contains("a radius of 0.2 m would do"));
  options.cell_size_m = 0.09;
  CHECK_THAT(Refusal(CheckWorlds, options), Catch::Contains("cell_size_m 0.0977"));
}

}  // namespace
}  // namespace conav::launcher
