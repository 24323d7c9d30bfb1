#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"

// One user: the service; pure, and tested without it.

namespace conav::operators {

struct DriveGateOptions {
  /// A driver keeps the robot for so long (wall time) after the last order.
  double hold_s = 5.0;
  /// An order may expire at most so far ahead (simulation time): silence must soon mean stop.
  double longest_valid_s = 5.0;
};

/// Decides which low-level actions are passed on to a robot's planner. Nothing is stored: an
/// action that was not carried out in time is void.
///
/// Refused: a robot of another world, or one that has not reported; an order that has expired, or
/// would be valid for too long; a request older than the client's newest; an order of another
/// client than the one that steers the robot, unless it is a stop, which everyone may send. A
/// repeat of the newest request gets the same answer and no second order.
/// Threads: not synchronised; one owner.
class DriveGate {
 public:
  DriveGate(std::map<std::string, std::string> world_of_robot, DriveGateOptions options);

  /// A robot reports; orders are numbered on from the last that it took up.
  void Receive(const RobotState& state);

  struct Answer {
    OperatorReply reply;
    std::optional<DriveOrder> order;  // to be passed on
  };
  /// `request` carries a DriveRequest; `now`: simulation time of its world, `wall`: wall time.
  Answer Handle(const OperatorRequest& request, SimTime now, Clock::TimePoint wall);

  /// Who steers `robot`; empty when nobody does.
  std::string DriverOf(const std::string& robot, Clock::TimePoint wall) const;

 private:
  struct Robot {
    std::string world;
    bool reported = false;
    std::uint64_t newest_order = 0;
    std::string driver;
    Clock::TimePoint driven_at{};
  };
  struct Client {
    std::uint64_t newest_request = 0;
    OperatorReply reply;
    Clock::TimePoint newest_at{};
  };

  std::optional<std::string> CheckAllowed(const OperatorRequest& request, const DriveRequest& drive,
                                          SimTime now, Clock::TimePoint wall) const;
  void ForgetOldClients(Clock::TimePoint wall);

  DriveGateOptions options_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, Client> clients_;
};

/// The request of the same client for the same robot that is newer than requests[index]: of a
/// burst, only the newest low-level action counts. Null when there is none, or when it is no
/// DriveRequest.
const OperatorRequest* ReplacedBy(const std::vector<OperatorRequest>& requests, std::size_t index);

}  // namespace conav::operators
