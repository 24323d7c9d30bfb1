#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "operator/recorder/arrivals.h"
#include "operator/recorder/config.h"

namespace conav::bus {
class Reader;
}

namespace conav::recorder {

/// What a recording says of one topic.
struct TopicFacts {
  std::string name;         // "/r1/state"
  std::string type;         // "conav_msgs/msg/RobotState"
  std::string offered_qos;  // OfferedQosText
};

/// The serialised messages of every topic that `config` wants: those of all robots, their worlds and
/// the system, but for streams and what is excluded.
///
/// A message is decoded as by any other subscriber of the bus, so that a malformed one is dropped,
/// and written again as plain little-endian CDR: what is recorded can be read.
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

}  // namespace conav::recorder
