#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/qos.h"
#include "common/bus/type_support.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "operator/recording/config.h"
#include "operator/recording/mcap_file.h"
#include "operator/recording/mcap_records.h"

// One user: main starts it; tests build it whole.

namespace conav::bus {
class Reader;
}

namespace conav::recorder {

/// A message as it came.
struct Arrival {
  std::uint16_t channel = 0;
  std::uint64_t log_time = 0;      // ns since 1970
  std::uint64_t publish_time = 0;  // ns: the stamp of its header, without one its log time
  bag::Bytes data;                 // CDR with its encapsulation
  bus::Guid writer{};
};

/// Messages on their way from the bus's receive threads to the thread that writes them. Their log
/// times are in order unless the wall clock is set back.
/// Threads: any for Add, one for the rest.
class Arrivals {
 public:
  using WallClock = std::function<std::uint64_t()>;  // ns since 1970

  /// When the writer is so slow that more than `limit_bytes` wait, newer ones are dropped and
  /// counted. `wake` is called when a quarter of that is reached.
  Arrivals(std::size_t limit_bytes, std::function<void()> wake, WallClock now = SystemTime);

  void Add(std::uint16_t channel, std::optional<std::uint64_t> stamp, bag::Bytes data,
           const bus::Guid& writer = {});

  /// All that came since the last call, oldest first.
  std::vector<Arrival> Take();

  /// Since the begin.
  std::uint64_t dropped() const;

  static std::uint64_t SystemTime();

 private:
  const std::size_t limit_bytes_;
  const std::function<void()> wake_;
  const WallClock now_;
  mutable std::mutex mutex_;  // guards what follows
  std::vector<Arrival> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

/// What a late joiner would get of latched topics: the newest message of each writer, also of one that
/// is gone, but of kWriters for each channel at most.
/// Threads: one.
class LatchedMessages {
 public:
  static constexpr std::size_t kWriters = 16;

  void Keep(Arrival arrival);
  /// By channel, in the order in which they came.
  const std::map<std::uint16_t, std::deque<Arrival>>& newest() const { return newest_; }

 private:
  std::map<std::uint16_t, std::deque<Arrival>> newest_;
};

/// The QoS that a topic's publishers offer, as rosbag2 (Humble and later) keeps it with a topic:
/// a YAML list of one profile. `ros2 bag play` publishes with it.
std::string OfferedQosText(const bus::Qos& qos);

/// What a recording says of one topic.
struct TopicFacts {
  std::string name;         // "/r1/state"
  std::string type;         // "conav_msgs/msg/RobotState"
  std::string offered_qos;  // OfferedQosText
  bool is_latched = false;  // a late joiner gets the newest message
};

/// The serialised messages of every topic that `config` wants: those of all robots, their worlds
/// and the system, but for streams and what is excluded (RawTopic).
class TopicListeners {
 public:
  /// `add_channel` is called for each topic and gives the channel of its arrivals. `arrivals`
  /// outlives this. Throws StartupError: an entry of robots or exclude that is wrong.
  TopicListeners(bus::Participant& participant, const RecorderConfig& config,
                 const std::function<std::uint16_t(const TopicFacts&)>& add_channel,
                 Arrivals& arrivals);
  ~TopicListeners();

  std::size_t topics() const { return readers_.size(); }
  /// Messages that were dropped because they could not be decoded.
  std::uint64_t malformed() const;

 private:
  std::vector<std::unique_ptr<bus::Reader>> readers_;
};

/// Writes the messages on the bus into MCAP files, one after the other: docs/recording.md.
///
/// Publishes its health and log only. A message is in the file a second later, at the latest
/// with the next period; so much a kill -9 can cost. When the disk fails, it says so in its log and
/// on /diagnostics, loses the messages of that second, and tries again with the next ones; the file
/// can be read at any time. Threads: one; Run() or repeated Step(), then Finish().
class RecorderService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError: the file cannot be made, the
  /// list of robots or of exclusions is wrong.
  RecorderService(bus::Participant& participant, const RecorderConfig& config, const Clock& clock);

  /// Blocks until `stop`, and then until nothing more arrives (one second at most); completes the
  /// file.
  void Run(const StopToken& stop);
  /// Takes what arrived. Blocks on the disk only. False when nothing did.
  bool Step();
  /// Writes the summary; nothing is recorded afterwards.
  void Finish();

 private:
  void Write(const Arrival& arrival, std::uint64_t log_time);
  /// Goes on in the next file when this one is full, and removes the oldest. Each file begins with what
  /// is latched, at the time of the newest message before. From memory: to subscribe again would bring
  /// every event's history with it, and make every process on the bus match hundreds of readers.
  void Rotate();
  void RemoveOldest() const;
  /// Writes the summary of this file.
  void Complete();
  std::uint64_t lost() const {
    return lost_in_earlier_ + writer_->lost() + arrivals_.dropped() - noted_dropped_;
  }
  /// What became of the disk since the file had `size_before` bytes.
  void Note(const Result<void>& written, std::uint64_t size_before);
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  const RecorderConfig config_;
  std::filesystem::path file_;
  std::optional<bag::McapWriter> writer_;
  std::uint64_t lost_in_earlier_ = 0;  // files
  std::uint64_t noted_dropped_ = 0;    // of the dropped ones, in files that are complete
  Arrivals arrivals_;
  std::vector<TopicFacts> topics_;  // by channel, from 1
  LatchedMessages latched_;
  std::uint64_t newest_log_time_ = 0;
  Clock::TimePoint chunk_since_{};      // the first message that waits for the next chunk
  std::optional<std::string> failure_;  // of the newest chunk
  LogLimit failures_logged_;
  Diagnostics diagnostics_;
  std::unique_ptr<TopicListeners> listeners_;
};

}  // namespace conav::recorder
