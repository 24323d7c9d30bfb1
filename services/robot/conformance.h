#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"

// One user: conav-doctor; the tests check the clauses against drivers with faults.

namespace conav::robot {

/// What a robot has published; the newest of each.
struct RobotReport {
  using Published = std::map<SimTime, std::chrono::system_clock::time_point>;

  std::optional<RobotState> state;
  std::optional<MapUpdate> map;
  std::optional<CameraLens> lens;
  std::optional<Snapshot> snapshot;
  std::vector<RobotState> states;  // all of them, oldest first
  // By the stamp of a map: when it was first sent, and the first state that names it, by the clock of
  // the computer that sent them. The map that was there at the start counts as sent at any time.
  Published maps_published;
  Published maps_named;
};

/// The robot on the other side: over the bus, or in a test.
class RobotUnderTest {
 public:
  virtual ~RobotUnderTest() = default;
  virtual const RobotReport& report() const = 0;
  virtual void Send(const RobotCommand& command) = 0;
  virtual void Send(const StopOrder& order) = 0;
  /// `command` with a heading that is no number.
  virtual void SendMalformed(const RobotCommand& command) = 0;
  /// Receives until `done` is true, `patience` at most (wall time); returns whether it became true.
  virtual bool WaitUntil(const std::function<bool()>& done, std::chrono::milliseconds patience) = 0;
};

struct ClauseResult {
  enum class Verdict : std::uint8_t { kHolds, kBroken, kNotChecked };
  std::string name;    // "stop"
  std::string clause;  // what docs/robots.md promises
  Verdict verdict = Verdict::kHolds;
  std::string seen;  // what the robot did instead, or why it was not checked; empty if it holds
};

struct ConformanceOptions {
  std::string robot = "r1";
  double step_m = 0.0;  // length of the drives; 0 = a cell of its map, at least 0.5 m
  /// For what a robot does at once; what takes it time may take twenty times as long.
  std::chrono::milliseconds patience{3000};
  /// How long nothing may happen where nothing is to happen.
  std::chrono::milliseconds quiet{500};
};

/// Drives `robot` a few metres to and fro in the free space of its map and checks each clause of
/// docs/robots.md. `progress` gets each result as soon as it is known. No planner may hold the
/// robot, and it may not be stopped: then the first clause says so and no other is checked. The
/// robot stands afterwards, resumed.
std::vector<ClauseResult> CheckConformance(
    RobotUnderTest& robot, const ConformanceOptions& options,
    const std::function<void(const ClauseResult&)>& progress = nullptr);

}  // namespace conav::robot
