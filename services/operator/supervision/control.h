#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"

namespace conav::operators {

/// Section `operator.control:`.
struct ControlOptions {
  /// A client that has taken control of robots, and neither asks for anything nor uses its page for
  /// so long, loses it (wall time). Pages report their use every 5 s.
  double control_s = 60.0;
  /// Robots are stopped until somebody resumes them, unless the database says that somebody did.
  bool start_stopped = false;

  void Visit(ConfigReader& reader) {
    reader.Field("control_s", control_s, 1.0, 86400.0);
    reader.Field("start_stopped", start_stopped);
  }
};

/// Which program a client's name belongs to: the writer of its first request. No other program asks under
/// that name, which is public, nor uses up its request ids.
///
/// A name that nobody used for kKept is free again. Pages and other clients of this very service need no
/// writer, and their names are theirs, whatever came before over DDS.
/// Threads: not synchronised; one owner.
class ClientNames {
 public:
  /// As DDS names a writer; with DDS security the certificate of its program determines the first bytes.
  using Writer = std::array<std::uint8_t, 16>;

  /// Longer than a client repeats a request.
  static constexpr std::chrono::hours kKept{24};
  static constexpr std::size_t kMostOfWriter = 256;
  static constexpr std::size_t kMost = 4096;

  /// Why `writer` may not ask as `client`; empty = it may, and from now on no other. `now`: wall time.
  std::string Claim(const std::string& client, const Writer& writer, Clock::TimePoint now);
  /// `client` is of this service.
  void ClaimOwn(const std::string& client, Clock::TimePoint now);

 private:
  struct Owner {
    Writer writer{};
    bool is_own = false;
    Clock::TimePoint used_at{};
  };

  std::map<std::string, Owner> owners_;  // by name
};

/// Who may command which robot, and which robots are stopped.
///
/// Nobody has control of a robot at first, and every operator may command it. A client that takes
/// control commands it alone until it releases it, does nothing for `control_s`, or another
/// client takes over, which must say why. Another client may also ask for control: it gets what is
/// released within kAskedFor, and the one that has control keeps it by taking it again. Stopping needs no control: anyone may stop and resume
/// robots. While one client has control of all robots of a world, its map is that client's, too.
///
/// `now`: wall time. Pure; threads: not synchronised.
class ControlRegistry {
 public:
  static constexpr std::chrono::seconds kAskedFor{30};

  struct Robot {
    std::string world;
    StopOrder stop;                        // revision 0 = never stopped
    bool confirmed_stopped = false;        // by the robot's own state
    std::uint64_t confirmed_revision = 0;  // of the newest order that it took
    std::string holder;
    std::string reason;
    Clock::TimePoint held_until{};
    std::string asked_by;  // client; empty = nobody asks for control
    std::string ask_reason;
    Clock::TimePoint asked_until{};
  };

  ControlRegistry(const std::map<std::string, std::string>& world_of_robot, ControlOptions options);

  /// Why `client` may not command `robot` or edit the map of `world`; empty = it may.
  std::string CheckCommand(const std::string& client, const std::string& robot,
                           Clock::TimePoint now) const;
  std::string CheckEdit(const std::string& client, const std::string& world,
                        Clock::TimePoint now) const;
  /// `client` is active: it keeps control.
  void Renew(const std::string& client, Clock::TimePoint now);

  /// Errors: kNotFound names a robot that is not known; kRefused: another client has control and no
  /// reason was given, or a third one asks for it already.
  [[nodiscard]] Result<void> Take(const std::string& client, const TakeControlRequest& request,
                                  Clock::TimePoint now);
  [[nodiscard]] Result<void> Release(const std::string& client,
                                     const ReleaseControlRequest& request, Clock::TimePoint now);
  /// `client` has gone.
  void ReleaseAll(const std::string& client, Clock::TimePoint now);
  /// Takes control from clients that were idle for too long.
  void Expire(Clock::TimePoint now);

  /// The orders that stop or resume these robots; they count once they are adopted. A robot is
  /// stopped again when it is stopped already, in case that it did not take the order. Each order is
  /// newer than what the robot reports. None to resume a robot that nobody has stopped. Errors:
  /// kNotFound.
  [[nodiscard]] Result<std::vector<StopOrder>> Stop(const std::string& client,
                                                    const StopRequest& request, SimTime now) const;
  [[nodiscard]] Result<std::vector<StopOrder>> Resume(const std::string& client,
                                                      const ResumeRequest& request,
                                                      SimTime now) const;
  void Adopt(const StopOrder& order);
  /// A robot reports whether it is stopped. Where another program resumed a robot that this service
  /// has stopped, the order that stops it again, to be published and adopted.
  std::optional<StopOrder> Receive(const RobotState& state);

  const std::map<std::string, Robot>& robots() const { return robots_; }
  /// Rises with every change.
  std::uint64_t version() const { return version_; }

 private:
  /// `names`, or all robots. Errors: kNotFound.
  Result<std::vector<std::string>> Resolve(const std::vector<std::string>& names) const;
  Result<std::vector<StopOrder>> SetStopped(const std::vector<std::string>& names, bool stopped,
                                            const std::string& client, const std::string& reason,
                                            SimTime now) const;
  void Hold(Robot& robot, const std::string& client, const std::string& reason,
            Clock::TimePoint now);
  /// Nobody has control from now on, or the client that asked for it.
  void Free(Robot& robot, Clock::TimePoint now);

  ControlOptions options_;
  std::map<std::string, Robot> robots_;
  std::uint64_t version_ = 1;
};

/// Decides which low-level actions are passed on to a robot's planner. Nothing is stored: an
/// action that was not carried out in time is void.
///
/// Refused: a robot of another world, or one that has not reported; an order that has expired, or
/// expires more than 5 s ahead (simulation time: silence must soon mean stop); a request older than the client's newest; an order of another
/// client than the one that steers the robot, unless it is a stop, which everyone may send. A
/// repeat of the newest request gets the same answer and no second order.
/// Threads: not synchronised; one owner.
class DriveGate {
 public:
  explicit DriveGate(const std::map<std::string, std::string>& world_of_robot);

  /// A robot reports; orders are numbered on from the last that it took up.
  void Receive(const RobotState& state);

  struct Answer {
    OperatorReply reply;
    std::optional<DriveOrder> order;  // to be passed on
  };
  /// `request` carries a DriveRequest; `now`: simulation time of its world, `wall`: wall time.
  Answer Handle(const OperatorRequest& request, SimTime now, Clock::TimePoint wall);

  /// Who steers `robot`: the client of the last order, for 5 s of wall time; empty = nobody.
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

  std::map<std::string, Robot> robots_;
  std::map<std::string, Client> clients_;
};

/// Which requests from the bus are void because they were under way for longer than 3 s, as those of a
/// client that was cut off: it has given them up, or repeats them.
///
/// A request is under way from its publication to its arrival, by the clocks of two hosts; the
/// quickest of the last minute of its client counts as their difference. A link that is cut for
/// longer is a new one, which delivers nothing old. Threads: not synchronised; one owner.
class RequestDelays {
 public:
  static constexpr double kLongestUnderWay = 3.0;  // s

  /// `published_s`, `arrived_s`: wall time of the client's host and of this one.
  bool IsLate(const std::string& client, double published_s, double arrived_s);

 private:
  struct Quickest {
    double delay_s = 0.0;
    double arrived_s = 0.0;
  };
  std::map<std::string, Quickest> quickest_;  // by client
};

/// The request of the same client for the same robot that is newer than requests[index]: of a
/// burst, only the newest low-level action counts. Null when there is none, or when it is no
/// DriveRequest.
const OperatorRequest* ReplacedBy(const std::vector<OperatorRequest>& requests, std::size_t index);

}  // namespace conav::operators
