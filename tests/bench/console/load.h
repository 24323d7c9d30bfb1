#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "bench/console/world.h"
#include "common/bus/participant.h"

namespace conav::bench {

struct LoadOptions {
  Drive drive;
  double state_hz = 20.0;
  double picture_hz = 2.0;
};

/// A picture comes with each so many-th state of a robot: as near to `picture_hz` as that goes, with
/// every state at most.
int StatesPerPicture(const LoadOptions& options);

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
  struct WorldLink;
  std::unique_ptr<WorldLink> world_;
  std::atomic<double> cpu_s_ = 0.0;
  std::atomic<double> lateness_ms_ = 0.0;
  std::mutex mutex_;  // guards stop_
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace conav::bench
