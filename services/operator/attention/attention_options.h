#pragma once

#include <string>

#include "common/protocol/supervision.h"

namespace conav {
class ConfigReader;
}

namespace conav::operators {

/// What is assumed of the operator's interaction times before any was measured: medians in seconds,
/// one log-normal spread for all, and how many interactions that is worth.
struct InteractionPriors {
  double picture_s = 8.0;
  double blocked_s = 10.0;
  double path_s = 10.0;   // no guidance, first path
  double notice_s = 5.0;  // a failed command, a lost link, goals reached
  double log_sd = 0.5;
  double weight = 3.0;

  double MedianOf(AttentionReason reason) const;
  void Visit(ConfigReader& reader);
};

/// Section `operator.attention:`; seconds are the operator's time, that is simulation time.
struct AttentionOptions {
  /// "priority", "fifo" or "nearest_deadline"; attention_order.h.
  std::string order = "priority";
  /// A newcomer takes the first place from an item of its tier when its score is this many times
  /// as high, or the first item has been first for `dwell_s`.
  double hysteresis_factor = 1.5;
  double dwell_s = 10.0;
  /// nearest_deadline: of questions that state none, counted from when they were asked.
  double default_deadline_s = 120.0;
  /// Reward units per second, where nobody says what waiting costs.
  double default_value_lost_per_s = 1.0;
  /// A lost link and reached goals are shown for so long, or until they are selected.
  double notice_s = 60.0;
  /// Of the rolling utilisation.
  double window_s = 300.0;
  /// A command for the same robot so soon after an answer belongs to the same interaction.
  double linger_s = 5.0;
  InteractionPriors priors;

  void Visit(ConfigReader& reader);
};

}  // namespace conav::operators
