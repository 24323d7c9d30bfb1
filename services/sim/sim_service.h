#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "sim/checkpoint_topics.h"
#include "sim/config.h"
#include "sim/motion_topics.h"
#include "sim/physics/camera.h"
#include "sim/robot_topics.h"
#include "sim/simulation_services.h"
#include "sim/world/episode.h"
#include "sim/world/world_spec.h"

// One user: main starts it; tests build it whole.

namespace conav::sim {

/// One world on the bus: owns the truth, moves the robots, takes their pictures.
///
/// With `checkpoint` a simulator that was killed goes on where it was; one that ends when asked begins
/// its world again next time.
///
/// Before the first command it publishes /clock (unless disabled), truth, initial map, goals,
/// transforms, and each robot's description, map and state. Stale input: it rejects and logs commands of an older lease or
/// sequence; a command past its expiry is void, and a robot without a command in force stands
/// still.
class SimService {
 public:
  /// Throws StartupError: impossible world, unreadable map, no usable EGL.
  SimService(bus::Participant& participant, const SimConfig& config, const Clock& clock);
  ~SimService();

  /// Blocks until `stop`. Call it on the thread that built the service: the OpenGL context belongs
  /// to it.
  void Run(const StopToken& stop);
  /// Takes over the speed. Any thread may call it.
  void Reconfigure(const SimConfig& config) { asked_speed_ = config.speed; }
  /// One iteration of Run: answers services, takes commands, advances time if due, publishes. False = nothing to do
  /// now.
  bool Turn();

 private:
  RobotTopics& TopicsOf(int robot) { return *robots_[static_cast<std::size_t>(robot)]; }
  void PublishRobots();
  /// The world, its robots and their topics; also instead of earlier ones.
  /// `resumes`: from the checkpoint, if there is one.
  void Start(bool resumes);
  void BuildWorld();
  void PublishWorld();
  /// Publishes when doors closed since the last call.
  void PublishTruth();
  /// Publishes when robots reached goals since the last call.
  void PublishGoals();
  void TakeCommands();
  Result<void> Accept(const RobotCommand& command, const std::string& robot);
  bool StepDue();
  /// Of wall time; 0 as fast as possible.
  std::chrono::nanoseconds StepPeriod() const;
  void Step();
  /// Those that are due; publishes their frames.
  std::vector<Snapshot> TakeSnapshots(const std::vector<std::uint64_t>& steps_before);
  Snapshot StreamedSnapshot(int robot);
  void PublishPictures(const std::vector<Snapshot>& pictures);
  void PublishFrame(int robot, const std::vector<std::uint8_t>& jpeg);
  /// Streams frames that belong to no low-level step while somebody watches: in methods that stream,
  /// of robots that stand still, because frames are not latched and a late viewer would see none; in
  /// the others at camera.live_hz.
  void StreamToViewers();
  std::vector<std::uint8_t> RenderJpeg(int robot);
  /// Fills in the view from the centre of its cell, or from `robot`'s own position.
  void Fill(Snapshot& snapshot) const;
  void FillFrom(int robot, Snapshot& snapshot) const;
  void Fill(Snapshot& snapshot, const CameraView& view) const;
  Health Report() const;

  bus::Participant& participant_;
  SimConfig config_;
  const Clock& clock_;
  WorldSpec spec_;
  std::unique_ptr<RobotWorld> physics_;
  std::unique_ptr<Episode> episode_;
  Checkpoint checkpoint_;
  std::unique_ptr<Camera> camera_;  // absent with camera.mode none
  std::vector<std::unique_ptr<RobotTopics>> robots_;
  std::vector<Clock::TimePoint> frame_sent_at_;  // by robot
  bus::Publisher<nav_msgs::msg::OccupancyGrid> truth_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  bus::Publisher<visualization_msgs::msg::MarkerArray> goals_;
  std::optional<MotionTopics> motion_;  // once the world is built
  SimulationServices services_;
  Diagnostics diagnostics_;
  std::atomic<double> asked_speed_;
  Clock::TimePoint next_step_{};
  std::uint64_t refused_commands_ = 0;
  int doors_published_ = -1;  // closed in the last truth
  int goals_published_ = -1;  // goals left in the last markers
};

}  // namespace conav::sim
