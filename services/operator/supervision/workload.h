#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "operator/supervision/attention_queue.h"

/// How many robots one operator can serve, and how long they wait: the formulas of the literature.
/// Times in seconds; `neglect_s` (NT) is how long a robot does without the operator,
/// `interaction_s` (IT) how long the operator needs for it.
namespace conav::operators {

/// FO = NT / IT + 1: the robots that one operator keeps going (D. R. Olsen and M. A. Goodrich,
/// "Metrics for evaluating human-robot interactions", PERMIS 2003). 0 when interaction_s is 0:
/// unknown.
double FanOut(double neglect_s, double interaction_s);

/// FO = NT / (IT + WT) + 1 with the waits per interaction, in the queue and for want of situation
/// awareness (M. L. Cummings and P. J. Mitchell, "Predicting controller capacity in supervisory
/// control of multiple UAVs", IEEE Trans. SMC-A 38(2), 2008). 0 when interaction_s is 0.
double FanOutWithWaits(double neglect_s, double interaction_s, double wait_s);

/// What the finite-source queue M/M/1//N predicts: N robots that each ask after an exponential time
/// of mean NT, one operator who needs an exponential time of mean IT (the machine repair model; for
/// example L. Kleinrock, "Queueing Systems" vol. 1, 1975, section 3.8; the operator as its server:
/// Cummings, Nehme and Crandall 2007).
struct FiniteSourcePrediction {
  double idle = 1.0;            // P0: nobody asks
  double utilisation = 0.0;     // 1 - P0
  double time_in_system = 0.0;  // W = N / (mu UT) - 1 / lambda, s
  double waiting_time = 0.0;    // W - 1 / mu, s
  double attended = 0.0;        // N - Lq: mean number of robots that do not wait
};

/// Without robots or without interactions (interaction_s 0) nobody waits. With neglect_s 0 all ask
/// at once.
FiniteSourcePrediction PredictFiniteSource(int robots, double neglect_s, double interaction_s);

/// Measures how busy the operator is and how long robots wait, from what happens to the queue.
///
///   IT   from a selection to the last command that its client had accepted for that robot or its
///        world, up to linger_s after the answer (Crandall, Goodrich, Olsen and Nielsen, IEEE
///        Trans. SMC-A 35(4), 2005)
///   NT   from when a robot's question left the queue until its next one came
///   WTQ  from a question to its selection, or, when nobody selected it, to its end; of open
///        questions, the time so far: an order that never serves some would look good otherwise
///   UT   share of the time in which an interaction was open, or somebody worked without having selected
///        a question: such a command counts for the linger_s before it
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
  /// A command of `client` was accepted: for a robot, or an edit of a world; empty for others.
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

  void Work(const std::string& client, SimTime start, SimTime now);
  void Close(Interaction& interaction, SimTime now);
  void Lengthen(const std::string& client, Interaction& interaction, SimTime now);
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
  std::map<std::string, SimTime> worked_to_;  // by client; until when its time is counted
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
