#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/protocol/planning.h"
#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/clock.h"

namespace conav::operators {

/// How the perception service expects the operator to edit the map after a picture.
struct Prediction {
  std::string robot;
  std::string world;
  std::uint64_t snapshot = 0;
  std::uint64_t belief_revision = 0;
  std::string model;
  PerceptionAnswer answer;
};

/// Asks the perception service, as planners do, about the newest picture of each robot, for the
/// console. A question without an answer is asked again, three times in all; then the page shows
/// none, and nothing else suffers.
/// Threads: one.
class PredictionDesk {
 public:
  static constexpr int kTries = 3;
  static constexpr std::chrono::seconds kRepeat{1};

  /// Both outlive it.
  PredictionDesk(bus::Participant& participant, const Clock& clock);

  /// `picture` came while the operator's map was `belief`. Pictures that show what lies beyond the map
  /// are left out.
  void Ask(const Picture& picture, const Belief& belief);
  /// The answers that came since the last call, to each robot's newest question only.
  std::vector<Prediction> Step();

 private:
  struct Question {
    Prediction of;  // without the answer
    PerceptionRequest request;
    int rows = 0;
    int columns = 0;
    int tries = 0;
    Clock::TimePoint repeat_at{};
  };

  void Send(Question& question);

  const Clock& clock_;
  std::string client_;
  std::uint64_t last_id_ = 0;
  std::map<std::string, Question> open_;  // by robot
  bus::Publisher<conav_msgs::msg::PerceptionRequest> requests_;
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies_;
};

}  // namespace conav::operators
