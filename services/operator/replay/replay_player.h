#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "operator/console/console_state.h"
#include "operator/gateway/picture_store.h"
#include "operator/replay/timeline.h"

namespace conav::operators {

/// Plays a timeline as if the console received it now.
///
/// Pages know wall time only: a value is as old for them as it is at this position of the
/// recording, also while it pauses or runs quicker. `now_s`: wall time, s since 1970.
/// Threads: one caller; what it fills may be read by others.
class ReplayPlayer {
 public:
  static constexpr double kFastest = 32.0;

  struct Shared {
    UpdateLog& updates;
    FrameSlots& frames;
    SnapshotStore& pictures;
  };

  /// Pauses at the beginning. Both outlive it.
  ReplayPlayer(const Timeline& timeline, Shared shared, double now_s);

  /// `elapsed_s` of wall time have passed. Pauses at the end.
  void Advance(double elapsed_s, double now_s);
  /// Either may be missing or not a number. Pages get what differs when it goes ahead, and
  /// everything again when it goes back.
  void Seek(std::optional<double> position_s, std::optional<double> speed, double now_s);
  /// The people at its pages.
  void Receive(std::vector<Person> people);

  double position_s() const { return position_s_; }
  /// Recorded seconds per second; 0 = paused.
  double speed() const { return speed_; }

 private:
  struct Play;  // passes one moment to the state

  void MoveTo(double position_s, double now_s);
  void Reset();
  /// Sends values with an age again, where pages count it wrongly by now.
  void Refresh(double now_s);
  void PutPlayback(double now_s);
  double ReceivedAt(double position_s, double now_s) const {
    return now_s - (position_s_ - position_s);
  }

  const Timeline& timeline_;
  Shared shared_;
  ConsoleState state_;
  std::vector<Person> people_;
  double position_s_ = 0.0;
  double speed_ = 0.0;
  std::size_t next_ = 0;     // moment
  double age_zero_s_ = 0.0;  // wall time of position 0, as pages know it
  double playback_said_at_s_ = 0.0;
  /// Numbers of the newest moments, by robot, process and alert.
  std::map<std::string, std::size_t> states_;
  std::map<std::string, std::size_t> pictures_;
  std::map<std::string, std::size_t> frames_;
  std::map<std::string, std::size_t> processes_;
  std::map<std::uint64_t, std::size_t> alerts_;
};

}  // namespace conav::operators
