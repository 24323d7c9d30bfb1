#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/result.h"

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
  /// "priority", "fifo" or "nearest_deadline"; ties go to the older item, then to the name.
  std::string order = "priority";
  /// A newcomer takes the first place from an item of its tier when its score is this many times
  /// as high, or the first item has been first for `dwell_s`.
  double hysteresis_factor = 1.5;
  double dwell_s = 10.0;
  /// nearest_deadline: of questions that state none, counted from when they were asked.
  double default_deadline_s = 120.0;
  /// Reward units per second, where the cost of waiting is not given.
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

/// The order of the attention queue.
///
///   priority          the tier first, then the c-mu index: value lost per second over the expected
///                     interaction time. In a queue with linear waiting costs and one server, this
///                     order has the least expected cost (D. R. Cox and W. L. Smith, "Queues",
///                     1961, section 3.3). Robots that stop asking while they wait make the source
///                     finite, for which it is a heuristic.
///   fifo              in the order of arrival.
///   nearest_deadline  the question that gives up first (Jackson's rule, 1955). Questions that wait
///                     for ever have a deadline default_deadline_s after they were asked; notices
///                     come last. Where a robot waits by the wall clock, its seconds are taken for
///                     those of the operator's time.
namespace conav::operators {

/// The names above.
const std::vector<std::string>& AttentionOrders();

/// 1 = first: the robot is standing because its command failed; 2 link lost; 3 blocked or without
/// a path, and asking; 4 a picture, which shows where the maps differ; 5 for information.
std::uint8_t TierOf(AttentionReason reason);
/// Whether the robot itself waits for an answer.
bool IsQuestion(AttentionReason reason);

/// Predicts how long the operator will need for an item, from how long such items took.
///
/// Interaction times are taken to be log-normal, as service times of people are (for example Nehme,
/// "Modeling human supervisory control in heterogeneous unmanned vehicle systems", MIT 2009). The
/// prior of each reason counts as `weight` interactions at its median with its log-sd; the expected
/// time is that of the log-normal with the pooled mean m and variance v of the logarithms: exp(m +
/// v / 2). Seconds.
class InteractionTimes {
 public:
  explicit InteractionTimes(const InteractionPriors& priors) : priors_(priors) {}

  /// Below a millisecond, which nobody needs, a time counts as one millisecond.
  void Add(AttentionReason reason, double seconds);
  /// An interaction that was added turned out to be longer.
  void Replace(AttentionReason reason, double before_s, double now_s);
  double Expected(AttentionReason reason) const;

 private:
  struct Sums {
    double count = 0.0;
    double logs = 0.0;
    double squares = 0.0;
  };

  InteractionPriors priors_;
  std::map<AttentionReason, Sums> sums_;
};

/// The attention queue, highest priority first: at most one item for each robot and reason.
///
///   comes when                                   leaves when
///   picture, blocked,   the robot asks           answered by guidance, withdrawn, answer timeout,
///   no guidance                                  the robot's planner is gone
///   first path          a robot with goals was   guidance
///                       never guided nor driven
///   command failed      refused or expired       the next command is taken up
///   link lost           nobody publishes it      it is back, selected, or notice_s passed
///   goals reached       none are left            selected, or notice_s passed
///
/// Whatever a robot asked leaves with its link and when it has no goals left. An edit alone answers
/// nothing: the robot still waits for a path. Asked again, an item keeps its place in time and
/// takes the newer numbers; the same question about a picture changes nothing. The first item stays
/// first until another one of its tier is clearly better (hysteresis) or it has dwelt there; a higher
/// tier goes first at once. Times are the operator's. Pure; threads: not synchronised.
class AttentionQueue {
 public:
  explicit AttentionQueue(const AttentionOptions& options) : options_(options) {}

  void Receive(const AttentionRequest& request, SimTime now);
  /// Also restores the link.
  void Receive(const RobotState& state, SimTime now);
  /// `guidance` was accepted, or is found in the database. One without a path that answers no
  /// picture answers nothing.
  void Receive(const Guidance& guidance, SimTime now);
  void LoseLink(const std::string& robot, SimTime now);
  /// The planner that would act on an answer is gone.
  void LosePlanner(const std::string& robot, SimTime now);
  /// Errors: kRefused, with a reason for the person: there is no such item, or another client works
  /// on it. A notice leaves with its selection.
  [[nodiscard]] Result<AttentionItem> Select(const std::string& client, const SelectRequest& select,
                                             SimTime now);
  /// Removes what has timed out, and sorts. Call it before items().
  void Update(const InteractionTimes& times, SimTime now);

  /// Highest priority first, as of the last Update().
  const std::vector<AttentionItem>& items() const { return items_; }
  /// Robots that have reported, have goals left and have a link.
  std::size_t robots_at_work() const;
  /// Of these, those that wait with a question that nobody has selected.
  std::size_t robots_waiting() const;

  struct Departure {
    AttentionItem item;
    SimTime at;
    bool answered = false;  // by guidance; false = it went without
  };
  /// What left since the last call, oldest first.
  std::vector<Departure> TakeDepartures() { return std::exchange(departures_, {}); }
  /// Questions that came since the last call.
  std::vector<AttentionItem> TakeArrivals() { return std::exchange(arrivals_, {}); }

 private:
  struct Robot {
    std::string world;
    bool linked = false;
    bool has_goals = false;
    bool guided = false;         // ever
    std::uint64_t answered = 0;  // newest picture
    std::uint64_t failed_command = 0;
  };

  AttentionItem* Find(const std::string& robot, AttentionReason reason);
  void Put(AttentionItem item, SimTime now);
  /// Whether it is about a picture, and stands in the queue already or has been answered.
  bool IsKnown(const AttentionRequest& request);
  /// Removes the items for which `leaves` holds.
  template <class Leaves>
  void Remove(bool answered, SimTime now, Leaves&& leaves);
  void RemoveQuestions(const std::string& robot, SimTime now);
  void KeepFirst(SimTime now);

  AttentionOptions options_;
  std::map<std::string, Robot> robots_;
  std::vector<AttentionItem> items_;
  std::vector<Departure> departures_;
  std::vector<AttentionItem> arrivals_;
  std::optional<std::pair<std::string, AttentionReason>> first_;
  SimTime first_since_;
};

}  // namespace conav::operators
