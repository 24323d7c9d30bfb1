#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "robot/conformance.h"

// One user: conformance.cc, which says what is checked; here stands how.

namespace conav::robot {

inline constexpr double kDriftM = 0.1;            // of a robot that stands
inline constexpr double kHeadingTolerance = 0.1;  // rad

std::string_view OutcomeName(CommandOutcome outcome);

/// Commands a robot and looks at what it does. Texts say what the robot did instead of what it has
/// to do; empty = it did that. Needs a state, and a map for FreePlace() and Obstacle().
class Probe {
 public:
  Probe(RobotUnderTest& robot, const ConformanceOptions& options)
      : robot_(robot), options_(options) {}

 protected:
  const RobotState& state() const { return *robot_.report().state; }
  RobotCommand Next(CommandKind kind);
  RobotCommand Drive(Position to);
  void SendStop(std::uint64_t revision, bool stopped);

  /// Waits as long as a robot may take for what it does at once, or for what takes it time.
  bool Soon(const std::function<bool()>& done) { return robot_.WaitUntil(done, options_.patience); }
  bool InTime(const std::function<bool()>& done);
  /// Whether it happens where nothing is to happen.
  bool Happens(const std::function<bool()>& what) { return robot_.WaitUntil(what, options_.quiet); }
  bool Shows(const RobotCommand& command, CommandOutcome outcome) const;
  bool Stands() const;

  /// Sends the command and waits for that outcome.
  std::string Expect(const RobotCommand& command, CommandOutcome outcome);
  /// Sends the command, which must change nothing.
  std::string ExpectIgnored(const RobotCommand& command, bool malformed = false);
  /// Waits until it stands, which it must do within `allowance_m` of `from`, and for a while longer.
  std::string Stays(Position from, double allowance_m = kDriftM);

  /// Where to drive from here: the free place of the map in one of the four directions; else
  /// nothing.
  std::optional<Position> FreePlace() const;
  std::optional<Position> Obstacle() const;
  /// Length of the drives.
  double StepM() const;
  /// How far it may roll on: it must not get where it was going.
  double Braking() const { return 0.45 * StepM(); }

  RobotUnderTest& robot_;
  const ConformanceOptions& options_;
  std::uint64_t epoch_ = 0;  // of the next command; sequence_number_ of the last
  std::uint64_t sequence_number_ = 0;

 private:
  bool IsFree(Position from, Position to) const;
};

}  // namespace conav::robot
