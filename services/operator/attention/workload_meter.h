#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "operator/attention/attention_queue.h"
#include "operator/attention/interaction_times.h"

namespace conav::operators {

/// Measures how busy the operator is and how long robots wait, from what happens to the queue.
///
///   IT   from a selection to the last command that its client had accepted for that robot or its
///        world, up to linger_s after the answer (Crandall, Goodrich, Olsen and Nielsen, IEEE Trans.
///        SMC-A 35(4), 2005)
///   NT   from when a robot's question left the queue until its next one came
///   WTQ  from a question to its selection, or, when nobody selected it, to its end; of those that
///        wait still, as far as they have waited, or an order that never serves some would look good
///   UT   share of the time in which an interaction was open
///
/// Means are those of the newest 1000; counts and sums of all. Seconds of the operator's time.
/// Pure; threads: not synchronised.
class WorkloadMeter {
 public:
  explicit WorkloadMeter(const AttentionOptions& options)
      : options_(options), times_(options.priors) {}

  const InteractionTimes& times() const { return times_; }

  void Arrived(const AttentionItem& item, SimTime now);
  void Selected(const std::string& client, const AttentionItem& item, SimTime now);
  /// A command of `client` for `robot` was accepted, or an edit of its world.
  void Accepted(const std::string& client, const std::string& robot_or_world, SimTime now);
  void Left(const AttentionQueue::Departure& departure);
  /// Call it with each change: what was true since the last call is weighed with the time since.
  void Advance(std::size_t robots_at_work, std::size_t robots_waiting, SimTime now);

  OperatorWorkload Workload(SimTime now) const;

 private:
  struct Interaction {
    std::string robot;
    std::string world;
    AttentionReason reason;
    SimTime start;
    std::optional<SimTime> last_command;
    bool is_over = false;      // answered
    std::uint64_t number = 0;  // in interaction_s_, once it is over
    double seconds = 0.0;      // likewise: from `start` to `last_command`
  };
  struct Span {
    SimTime start;
    SimTime end;
  };

  void Close(Interaction& interaction, SimTime now);
  void Lengthen(Interaction& interaction, SimTime now);
  double BusyInWindow(SimTime now) const;
  /// The waits that have ended and those that have not.
  std::deque<double> Waits(SimTime now) const;
  void EndWait(const AttentionItem& item, SimTime now);

  AttentionOptions options_;
  InteractionTimes times_;
  std::map<std::string, Interaction> open_;        // by client; the last one, over or not
  std::map<std::string, SimTime> neglect_since_;   // by robot
  std::map<std::uint64_t, double> interaction_s_;  // by number
  std::deque<double> neglect_s_;
  std::deque<double> wait_s_;  // of those that have ended
  std::map<std::pair<std::string, AttentionReason>, SimTime> waiting_since_;  // the others
  std::deque<Span> busy_spans_;
  std::uint64_t interactions_ = 0;
  std::uint64_t abandoned_ = 0;
  double busy_s_ = 0.0;  // of what is over
  double value_lost_ = 0.0;
  std::optional<SimTime> observed_since_;
  SimTime advanced_to_;
  std::size_t robots_at_work_ = 0;
  std::size_t robots_waiting_ = 0;
  double robot_s_ = 0.0;
  double waiting_robot_s_ = 0.0;
};

}  // namespace conav::operators
