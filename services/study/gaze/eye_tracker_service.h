#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "study/gaze/eye_recording.h"
#include "study/gaze/pupil_remote.h"

namespace conav {
class ConfigReader;
}

// One user: main starts it; tests build it whole.
namespace conav::gaze {

/// Section `eye_tracker:` of a config file.
struct EyeTrackerConfig {
  static constexpr const char* kRole = "tools";  // in the keystore

  bus::ParticipantOptions bus;
  /// Of Pupil Remote, as Pupil Capture shows it.
  std::string address = "tcp://127.0.0.1:50020";
  /// Pupil Capture records, too, while this program is connected.
  bool record = false;
  /// Name of that recording's folder; empty = Pupil Capture's own choice.
  std::string recording_name;

  void Visit(ConfigReader& reader);
};

/// Publishes what a Pupil Core sees (EyePupil, EyeGaze, EyeFixation, EyeBlink), with Pupil's times and
/// those of UTC, and the clock that converts them (EyeClock). Sends the marks of a study and the command
/// log to Pupil as annotations.
///
/// Publishes nothing but its health before Pupil answers. Connects again, each kRetryPeriod, when Pupil is
/// silent or was started again. Marks wait for the connection, up to kWaitingLimit of them; those from
/// before this program's start are left out. A message that cannot be read is counted and logged.
/// Threads: one; Run() or repeated Step().
class EyeTrackerService {
 public:
  static constexpr std::chrono::seconds kRetryPeriod{2};
  static constexpr std::chrono::seconds kProbePeriod{5};
  static constexpr std::chrono::seconds kQuietLimit{3};  // without any message: a warning
  static constexpr std::size_t kWaitingLimit = 1000;

  /// `participant` and `clock` outlive it. Throws StartupError for an address that names no port.
  EyeTrackerService(bus::Participant& participant, const EyeTrackerConfig& config,
                    const Clock& clock);

  /// Blocks until `stop`; then ends the recording of Pupil Capture that it began.
  void Run(const StopToken& stop);
  /// Takes what came; blocks for `limit` at most when nothing does, and for PupilRemote's limits.
  void Step(std::chrono::milliseconds limit);

 private:
  struct Annotation {
    double utc_s = 0.0;
    std::string label;
    std::map<std::string, std::string> keys;
  };

  void Connect();
  void Disconnect(const Error& reason);
  void Probe();
  void Take(const PupilMessage& message);
  void Publish(const EyeDatum& datum);
  void PublishClock();
  void TakeMarks();
  void SendAnnotations();
  void Queue(Annotation annotation);
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  const EyeTrackerConfig config_;
  const double started_s_;  // UTC
  bus::Publisher<conav_msgs::msg::EyePupil> pupils_;
  bus::Publisher<conav_msgs::msg::EyeGaze> gaze_;
  bus::Publisher<conav_msgs::msg::EyeFixation> fixations_;
  bus::Publisher<conav_msgs::msg::EyeBlink> blinks_;
  bus::Publisher<conav_msgs::msg::EyeClock> clocks_;
  bus::Subscriber<conav_msgs::msg::StudyMark> marks_;
  bus::Subscriber<conav_msgs::msg::OperatorEvent> events_;
  std::optional<PupilRemote> remote_;
  std::string problem_ = "not connected yet";  // why remote_ is empty
  std::deque<Annotation> waiting_;
  Clock::TimePoint connect_at_{};
  Clock::TimePoint probe_at_{};
  Clock::TimePoint newest_{};                    // message
  std::map<std::string, std::uint64_t> counts_;  // of messages and annotations, for the health
  LogLimit malformed_logged_;
  Diagnostics diagnostics_;
};

}  // namespace conav::gaze
