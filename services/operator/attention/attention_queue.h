#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/result.h"
#include "operator/attention/attention_options.h"
#include "operator/attention/attention_order.h"
#include "operator/attention/interaction_times.h"

namespace conav::operators {

/// What asks for the operator, in order: at most one item for each robot and reason.
///
///   comes when                                   leaves when
///   picture, blocked,   the robot asks           answered by guidance, asked no more, answer timeout,
///   no guidance                                  the robot's planner is gone
///   first path          a robot with goals was   guidance
///                       never guided nor driven
///   command failed      refused or expired       the next command is taken up
///   link lost           nobody publishes it      it is back, selected, or notice_s passed
///   goals reached       none are left            selected, or notice_s passed
///
/// Whatever a robot asked leaves with its link and when it has no goals left. An edit alone answers
/// nothing: the robot still waits for a path. Asked again, an item keeps its place in time and takes
/// the newer numbers. The first item stays first until another one of its tier is clearly better
/// (hysteresis) or it has dwelt there; a higher tier goes first at once.
/// Times are the operator's. Pure; threads: not synchronised.
class AttentionQueue {
 public:
  explicit AttentionQueue(const AttentionOptions& options) : options_(options) {}

  void Hear(const AttentionRequest& request, SimTime now);
  /// Also tells that the link is there.
  void Hear(const RobotState& state, SimTime now);
  /// `guidance` was accepted, or is found in the database. One without a path that answers no
  /// picture answers nothing.
  void Hear(const Guidance& guidance, SimTime now);
  void LoseLink(const std::string& robot, SimTime now);
  /// Nobody is there any more who would act on an answer to what the robot asked.
  void LosePlanner(const std::string& robot, SimTime now);
  /// Errors: kRefused, with a reason for the person: there is no such item, somebody else works on
  /// it. A notice leaves with its selection.
  [[nodiscard]] Result<AttentionItem> Select(const std::string& client, const SelectRequest& select,
                                             SimTime now);
  /// Lets go of what has timed out, and sorts. Call it before items().
  void Update(const InteractionTimes& times, SimTime now);

  /// First first, as of the last Update().
  const std::vector<AttentionItem>& items() const { return items_; }
  /// Robots that have been heard of, have goals left and have a link.
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
