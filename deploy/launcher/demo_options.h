#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/msg/method.h"
#include "common/msg/planning.h"
#include "common/runtime/result.h"

namespace conav::launcher {

/// The services that a demo runs, in the order in which they start.
inline constexpr const char* kServices[] = {"recorder", "sim",     "nhpm",
                                            "operator", "planner", "simulated-operator"};
inline constexpr int kMaxRobots = 128;  // as of sim/physics
inline constexpr int kMaxWorlds = 16;
inline constexpr int kMaxReplicas = 8;
inline constexpr int kMaxPlanners = 16;

/// The options of `conav demo`.
struct DemoOptions {
  int robots = 1;  // in each world
  int worlds = 1;
  std::uint64_t seed = 1;
  /// Of the first world only, further worlds count up from it; without it `seed`.
  std::optional<std::uint64_t> maze_seed;
  int rotation_deg = 0;  // of every world: 0, 90, 180, 270
  /// The simulated operator: one of operators::OperatorKinds(), or a file whose section
  /// `simulated_operator:` has a `person`.
  std::string simulated_operator = "careful";
  MethodKind method = MethodKind::kIgMcts;
  /// Of method ig-mcts: a preset of planner.search, or a YAML file with `search: {its keys}`; empty = the
  /// one for the kind of world.
  std::string search;
  std::optional<double> mapping_value;  // SearchConfig::mapping_value
  std::string
      scenario;  // of deploy/config/scenarios.yaml; sets the world, the robots and the person
  std::string communication = "search";  // policy that decides when ig-mcts sends a picture
  /// "cyclonedds", "fastdds", "mixed" or "service=vendor,..."; empty = the bus's default.
  std::string dds;
  bool headless = false;
  /// `conav soak`: robots have the goals that clients give, without end; recordings are limited, and
  /// caches so small that they are full soon.
  bool endless = false;
  std::filesystem::path json;
  /// Simulation time over wall time; 0 = as fast as commands arrive. Default 2 with a console, else
  /// 4; headless 0.
  std::optional<double> speed;
  std::string camera = "egl";
  std::optional<int> domain;  // default: the first free one
  std::string interface = "lo";
  std::vector<std::string> peers;
  std::optional<bus::RosDistribution> ros;  // ParticipantOptions::ros_distribution
  std::string world = "maze";      // or "waterway": open terrain, and the search and model for it
  std::string preset = "conav13";  // of the maze
  std::filesystem::path map;       // a map_server .yaml file; any other is a height map
  std::filesystem::path operator_map;
  std::optional<double> cell_size_m;     // of `map`
  std::optional<double> water_level;     // of a height map, in pixel values
  std::optional<double> resolution_m;    // of a height map's pixels
  std::optional<double> robot_radius_m;  // in open terrain
  std::optional<double> teleop_mps;      // forward speed under teleop; the others scale with it
  bool shared_goals = false;
  std::map<std::string, std::string> run_with;  // service -> command to put before it
  /// Wall time; default 1800, with people at the console none.
  std::optional<double> time_limit_s;
  std::string perception = "remote";
  std::optional<PerceptionModelKind> model;  // default: the network for the kind of world
  std::filesystem::path weights;         // of the network; empty = the one that comes with conav
  std::string person;                    // whose edits are predicted; empty = everybody's
  std::filesystem::path person_weights;  // folder with <person>.nhpm
  int nhpm_replicas = 1;
  int planners = 1;
  std::string x_source = "observed";  // or "estimated", "none"
  std::filesystem::path out = "runs";
  /// Port of the operator's console on this machine, 0 = any free one, -1 = none. Default 8080,
  /// headless none.
  std::optional<int> console;
  /// Port for Foxglove on this machine, 0 = any free one, -1 = none.
  int foxglove = -1;
  bool recording = true;  // the run folder gets a recording.mcap,
  bool streams = false;   // including the streamed pictures of the cameras

  double effective_speed() const {
    return speed.value_or(headless ? 0.0 : waits_for_operator() ? 2.0 : 4.0);
  }
  int console_port() const { return console.value_or(headless ? -1 : 8080); }
  /// The page's user starts the robots, and may guide them instead of the simulated operator.
  bool waits_for_operator() const { return console_port() >= 0 && !headless; }
  double effective_time_limit_s() const {
    return time_limit_s.value_or(waits_for_operator() ? std::numeric_limits<double>::infinity()
                                                      : 1800.0);
  }
  bool is_waterway() const { return world == "waterway"; }
  bool has_height_map() const;
  /// Robots drive anywhere, not from the middle of a cell to the next.
  bool is_open() const;
  /// Of the simulator's world.
  std::string effective_preset() const { return is_waterway() ? world : preset; }
  PerceptionModelKind effective_model() const {
    return model.value_or(is_open() ? PerceptionModelKind::kEncoderDecoder
                                    : PerceptionModelKind::kNhpm);
  }
  std::uint64_t world_seed() const { return maze_seed.value_or(seed); }
  /// None if the planner runs its own model.
  int nhpm_processes() const { return perception == "embedded" ? 0 : nhpm_replicas; }
};

/// Rejects impossible options: names the option, its value and what is allowed. Checks maps,
/// weights, --json's folder and --out in the file system.
[[nodiscard]] Result<void> Validate(const DemoOptions& options);

/// Parses "sim=ip netns exec a" into service and command. Rejects: no '=', unknown service, no
/// command.
[[nodiscard]] Result<std::pair<std::string, std::string>> ParseRunWith(const std::string& text);

/// The vendor of each process, including "launcher"; an empty text is the bus's default. "mixed"
/// alternates between the services; the recorder gets the first vendor and does not count.
[[nodiscard]] Result<std::map<std::string, std::optional<bus::Vendor>>> VendorOfService(
    const std::string& dds);

}  // namespace conav::launcher
