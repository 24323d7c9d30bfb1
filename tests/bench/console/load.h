#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/publisher.h"
#include "common/grid/grid.h"

namespace conav::bench {

/// What is played to the console: robots that drive eastwards through a square world, each in a row
/// of its own, and begin again in the west. A robot's place tells the time.
struct Drive {
  int robots = 16;       // 1..26: each has a letter of its own on the map
  int side = 150;        // cells; at least robots + 2
  double begin_s = 0.0;  // wall time at which they set out

  static constexpr double kCellSizeM = 2.0;
  static constexpr double kSpeedMps = 0.8;  // as a person drives them

  /// s until they begin again.
  double PeriodS() const;
  /// x of a robot that begins.
  double WestM() const;
  /// s between `now_s` and the time at which a robot was at `x_m`.
  double AgeS(double x_m, double now_s) const;
};

std::string RobotName(int robot);  // "r1" for 0

struct LoadOptions {
  Drive drive;
  double state_hz = 20.0;
  double picture_hz = 2.0;

  /// A picture comes with each so many-th state of a robot: as near to `picture_hz` as that goes,
  /// with every state at most.
  int StatesPerPicture() const;
};

/// Publishes what simulators of these robots would, until it is destroyed: state, map whenever a
/// cell is entered, and at `picture_hz` each a snapshot and a frame of the live view, with the same
/// JPEG. The robots do so one after the other, evenly over the period, as robots do that have
/// nothing to do with each other.
///
/// Threads: one of its own.
class Load {
 public:
  /// Begins with the world's initial map. `participant` outlives it.
  Load(bus::Participant& participant, const LoadOptions& options);
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  /// s of processor time of its thread.
  double cpu_s() const { return cpu_s_; }
  /// How late it was with a state at most, in ms, since the call before.
  double TakeLatenessMs() { return lateness_ms_.exchange(0.0); }
  std::size_t picture_bytes() const;  // of one, on average

 private:
  struct RobotLink;

  void Run();
  /// False when it shall end.
  bool WaitUntil(double wall_s);
  void Publish(RobotLink& robot, std::uint64_t round, double due_s);

  const LoadOptions options_;
  const OccupancyGrid truth_;
  const std::vector<std::vector<std::uint8_t>> jpegs_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  std::atomic<double> cpu_s_ = 0.0;
  std::atomic<double> lateness_ms_ = 0.0;
  std::mutex mutex_;  // guards stop_
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace conav::bench
