#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/clock_offset.h"
#include "common/runtime/result.h"

// One user: the service; apart because it knows the sockets and no bus.
namespace conav::gaze {

/// The tracker's clock against UTC. Times in s.
struct TrackerClock {
  double utc_s = 0.0;  // since 1970
  double pupil_s = 0.0;
  double round_trip_s = 0.0;
  double drift = 0.0;  // pupil_s per utc_s, less 1; since the first probes

  double ToUtc(double pupil) const { return utc_s + (pupil - pupil_s); }
  double ToPupil(double utc) const { return pupil_s + (utc - utc_s); }
};

/// A message of Pupil Capture's bus.
struct PupilMessage {
  std::string topic;
  std::vector<std::uint8_t> payload;  // MessagePack; further frames (pictures) are left out
};

/// Pupil Capture's network interface: Pupil Remote for questions, and the bus behind it (Pupil Core 3.x).
///
/// Constructing connects: asks for version and ports, probes the clock, subscribes, and starts the
/// plugin for annotations. ZeroMQ reconnects silently and drops what nobody takes, so its owner asks
/// CheckAlive() regularly and makes a new one after an error.
/// Threads: one. All calls block for at most the time limits below.
class PupilRemote {
 public:
  static constexpr std::chrono::milliseconds kReplyLimit{1000};
  /// A subscriber that connects takes this long to be known to the publisher: annotations before it are
  /// lost.
  static constexpr std::chrono::milliseconds kJoinTime{1200};
  static constexpr int kProbes = 10;

  /// `address`: of Pupil Remote, "tcp://127.0.0.1:50020". Errors: kUnavailable, kMalformed with the
  /// address and what it replied.
  [[nodiscard]] static Result<PupilRemote> Connect(const std::string& address);
  PupilRemote(PupilRemote&&) noexcept;
  PupilRemote& operator=(PupilRemote&&) noexcept;
  ~PupilRemote();

  /// Sends one of Pupil Remote's commands; its reply. Errors: kUnavailable.
  [[nodiscard]] Result<std::string> Ask(const std::string& command);
  /// Probes the clock again. Errors: kUnavailable: silent, or another process has the address (its
  /// ports are others); kMalformed.
  [[nodiscard]] Result<TrackerClock> CheckAlive();
  /// The next message; blocks for up to `limit`. Nothing: none came.
  std::optional<PupilMessage> Receive(std::chrono::milliseconds limit);
  /// False before kJoinTime is over.
  bool MayAnnotate() const;
  /// `keys` do not replace label, time and duration.
  void Annotate(const std::string& label, double pupil_s,
                const std::map<std::string, std::string>& keys);

  const std::string& version() const;
  const TrackerClock& clock() const;

 private:
  struct Sockets;
  explicit PupilRemote(std::unique_ptr<Sockets> sockets);

  Result<int> AskPort(const std::string& command);
  Result<void> Join();
  Result<void> Probe();

  std::unique_ptr<Sockets> sockets_;
};

}  // namespace conav::gaze
