#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/grid/wing.h"
#include "common/runtime/config.h"

namespace conav::sim {

/// A map from a file, used instead of a maze.
struct MapFileConfig {
  /// ROS map_server file of the truth; empty = a maze.
  std::string yaml;
  /// A PNG or TIFF of 8 or 16 bits whose values are heights: water below `water_level` (in pixel
  /// values), land from there on. The world is open.
  std::string height_map;
  double water_level = 128.0;
  /// Side of a height map's pixel. A map_server file has its own resolution.
  double resolution_m = 1.0;
  /// The operator's outdated plan of the same building; empty = the truth, corrupted with the seed.
  std::string operator_yaml;
  /// Of navigation cells; under 1 m the world is open.
  double cell_size_m = 2.0;
  /// A navigation cell with more occupied pixels than this share is a wall.
  double occupied_share = 0.25;
  /// Robots drive anywhere, not from the middle of a cell to the next.
  bool open = false;

  void Visit(ConfigReader& reader) {
    reader.Field("yaml", yaml);
    reader.Field("operator_yaml", operator_yaml);
    reader.Field("height_map", height_map);
    reader.Field("water_level", water_level, 0.0, 65535.0);
    reader.Field("resolution_m", resolution_m, 0.001, 1000.0);
    reader.Field("cell_size_m", cell_size_m, 0.1, 100.0);
    reader.Field("occupied_share", occupied_share, 0.0, 1.0);
    reader.Field("open", open);
  }
};

/// The size of the preset waterway (docs/waterway.md).
struct TerrainConfig {
  int rows = 150;
  int columns = 150;
  double cell_size_m = 1.0;

  void Visit(ConfigReader& reader) {
    reader.Field("rows", rows, 100, 1024);
    reader.Field("columns", columns, 100, 1024);
    reader.Field("cell_size_m", cell_size_m, 0.1, 100.0);
  }
};

/// The robots' bodies. In a maze the radius is 0.2 m.
struct BodyConfig {
  double radius_m = 0.2;
  double top_speed_mps = 2.0;

  void Visit(ConfigReader& reader) {
    reader.Field("radius_m", radius_m, 0.05, 2.0);
    reader.Field("top_speed_mps", top_speed_mps, 0.1, 2.0);
  }
};

struct CameraConfig {
  /// "egl" renders. "none" sends pictures that carry no pixels, only the cells they would show, and
  /// no frames; both count as the method sends them, with 0 bytes each.
  std::string mode = "egl";
  int width = 320;
  int height = 192;
  int jpeg_quality = 90;
  /// For instruction following and teleoperation: one frame per low-level step of a robot, and a
  /// streamed snapshot of what it shows. While a robot stands and a viewer subscribes, two more
  /// frames per second of wall time, which do not count.
  bool stream = false;
  /// For the other methods: frames per second of wall time while a viewer subscribes. Their bytes
  /// count apart, as camera_bytes.
  double live_hz = 5.0;

  void Visit(ConfigReader& reader) {
    reader.Choice("mode", mode, {"egl", "none"});
    reader.Field("width", width, 16, 4096);
    reader.Field("height", height, 16, 4096);
    reader.Field("jpeg_quality", jpeg_quality, 1, 100);
    reader.Field("stream", stream);
    reader.Field("live_hz", live_hz, 0.1, 30.0);
  }
};

/// Speeds of teleoperation, at which a low-level action of 0.25 s ends (docs/methods.md). The
/// motors reach 2 m/s and 73 degrees per second.
struct DriveConfig {
  static constexpr double kMostTurnDegPerS = 73.0;

  double forward_mps = 0.8;
  double backward_mps = 0.4;
  double turn_deg_per_s = 45.0;

  void Visit(ConfigReader& reader) {
    reader.Field("forward_mps", forward_mps, 0.1, 2.0);
    reader.Field("backward_mps", backward_mps, 0.0, 2.0);
    reader.Field("turn_deg_per_s", turn_deg_per_s, 5.0, kMostTurnDegPerS);
  }

  /// Drives forward at `mps`; the other speeds keep their ratio to it, up to the motors' limits.
  void ScaleTo(double mps) {
    const double factor = mps / forward_mps;
    *this = {mps, backward_mps * factor, std::min(kMostTurnDegPerS, turn_deg_per_s * factor)};
  }
};

/// The errors of the operator's initial map (docs/paper.md).
struct CorruptionConfig {
  double wrong_share = 0.12;      // of all cells, in open terrain of the free ones
  double false_wall_share = 0.5;  // of the wrong cells
  /// A half of a maze's map that is wrong as a whole besides.
  WingError wing_error = WingError::kNone;

  void Visit(ConfigReader& reader) {
    reader.Field("wrong_share", wrong_share, 0.0, 0.5);
    reader.Field("false_wall_share", false_wall_share, 0.0, 1.0);
    reader.Choice("wing_error", wing_error, kWingErrors);
  }
};

/// Which transforms the robots have: both conventions of ROS 2 users (docs/ros2.md).
struct TransformsConfig {
  /// /<robot>/tf and /<robot>/tf_static with plain frame ids.
  bool robot = true;
  /// /tf and /tf_static with frame ids as r1/base_link, for all robots in one tree.
  bool fleet = true;

  void Visit(ConfigReader& reader) {
    reader.Field("robot", robot);
    reader.Field("fleet", fleet);
  }
};

/// Section `sim:` of a config file: one world and its robots.
struct SimConfig {
  static constexpr bool kKeepsFreedMemory = true;  // it draws
  bus::ParticipantOptions bus;
  std::string world = "w1";
  std::vector<std::string> robots{"r1"};
  std::uint64_t seed = 1;
  /// A maze's, or waterway.
  std::string preset = "conav13";
  TerrainConfig terrain;
  MapFileConfig map;
  BodyConfig body;
  /// Goals of each robot; 0 = the preset's number.
  int goals_per_robot = 0;
  /// One list of goals for all; the first robot to reach one claims it.
  bool shared_goals = false;
  /// False: goals stand in the world, and the operator service keeps each robot's goals, as in the
  /// field (docs/robots.md).
  bool keeps_goals = true;
  /// [row, column] of each robot's start, and of the goals of every robot; empty = drawn.
  std::vector<std::vector<int>> starts;
  std::vector<std::vector<int>> goals;
  /// Of a maze: up to so many cells on the first robot's way become walls while it drives.
  int closing_doors = 0;
  /// 0, 90, 180 or 270, counter-clockwise: the same world turned, with starts, goals and the
  /// operator's map, for participants who have seen the world before (paper, section 6.2).
  int rotation_deg = 0;
  /// How far a robot sees around itself, in cells; walls occlude. 0 = 2 in a maze, for which the
  /// paper gives no number, and the paper's 50 in open terrain.
  double observation_distance_cells = 0.0;
  CorruptionConfig corruption;
  CameraConfig camera;
  DriveConfig drive;
  TransformsConfig tf;
  /// Clock, odometry and transforms per second of simulation time while a subscriber asks for them
  /// (ROS 2 tools do, conav's services do not); else one per control step, 4. 4 = never more.
  double motion_hz = 50.0;
  /// Simulated seconds per wall second; 0 = as fast as the robots are commanded.
  double speed = 0.0;
  /// False if another world's sim publishes /clock, since a domain has only one. Stamps always use
  /// the time of their own world.
  bool publish_clock = true;
  /// File from which a simulator that was killed goes on; empty = its world begins again. One that
  /// ends when asked removes it.
  std::string checkpoint;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("world", world);
    reader.Field("robots", robots);
    reader.Field("seed", seed);
    reader.Field("preset", preset);
    reader.Section("terrain", terrain);
    reader.Section("map", map);
    reader.Section("body", body);
    reader.Field("goals_per_robot", goals_per_robot, 0, 100);
    reader.Field("shared_goals", shared_goals);
    reader.Field("keeps_goals", keeps_goals);
    reader.Field("starts", starts);
    reader.Field("goals", goals);
    reader.Field("closing_doors", closing_doors, 0, 100);
    reader.Field("rotation_deg", rotation_deg, 0, 270);
    reader.Field("observation_distance_cells", observation_distance_cells, 0.0, 100.0);
    reader.Section("corruption", corruption);
    reader.Section("camera", camera);
    reader.Section("drive", drive);
    reader.Section("tf", tf);
    reader.Field("motion_hz", motion_hz, 4.0, 200.0);
    reader.Field("speed", speed, 0.0, 1000.0);
    reader.Live();
    reader.Field("publish_clock", publish_clock);
    reader.Field("checkpoint", checkpoint);
  }
};

}  // namespace conav::sim
