#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/bus/participant.h"
#include "common/runtime/clock.h"
#include "common/runtime/log_limit.h"
#include "common/runtime/stop_token.h"
#include "common/service/diagnostics.h"
#include "operator/bag/mcap_writer.h"
#include "operator/recorder/arrivals.h"
#include "operator/recorder/config.h"
#include "operator/recorder/topic_listeners.h"

namespace conav::recorder {

/// Writes what is said on the bus into one MCAP file: docs/recording.md.
///
/// Publishes its health and log only. What arrives is in the file a second later, at the latest with
/// the next period; so much a kill -9 can cost. When the disk fails, it says so in its log and on
/// /diagnostics, loses the messages of that second, and tries again with the next ones; the file
/// can be read at any time.
/// Threads: one; Run() or repeated Step(), then Finish().
class RecorderService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError: the file cannot be made or
  /// exists, the list of robots or of exclusions is wrong.
  RecorderService(bus::Participant& participant, const RecorderConfig& config, const Clock& clock);

  /// Blocks until `stop`, and then until nothing more arrives (two seconds at most); completes the
  /// file.
  void Run(const StopToken& stop);
  /// Takes what arrived. Blocks on the disk only. False when nothing did.
  bool Step();
  /// Writes the summary; nothing is recorded afterwards.
  void Finish();

 private:
  void Write(const Arrival& arrival);
  /// What became of the disk since the file had `size_before` bytes.
  void Note(const Result<void>& written, std::uint64_t size_before);
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  const std::string file_;
  bag::McapWriter writer_;
  Arrivals arrivals_;
  Clock::TimePoint chunk_since_{};      // the first message that waits for the next chunk
  std::optional<std::string> failure_;  // of the newest chunk
  LogLimit failures_logged_;
  Diagnostics diagnostics_;
  std::optional<TopicListeners> listeners_;
};

}  // namespace conav::recorder
