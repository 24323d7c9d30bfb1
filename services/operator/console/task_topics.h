#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "console.pb.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/console/participant_task.h"
#include "operator/supervision/control.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// The operator service's part of a mapping task or a study, of which it runs one step
/// (ParticipantTask): receives the true maze, decides when the participant may finish, ends what has
/// a time limit, publishes marks (StudyMark), and writes the result.
///
/// The result file is on disk before a Finish, answers or an abort are acknowledged; with such a file
/// from before, the step is finished from the start. Of a step under way, times, pauses, notes and a
/// half-filled form are on disk too ("<result>.draft"), so that a restart goes on there; at most
/// kSavePeriod of its time is lost, and the time without the service does not count.
///
/// A form begins when a participant's page is there, a rest when they ask for it, a maze when a robot
/// is resumed. A pause stops the robots; those that drove are resumed after it.
/// Threads: one, the service's.
class TaskTopics {
 public:
  static constexpr std::chrono::seconds kSavePeriod{5};

  /// `participant`, `store` and `clock` outlive it. Throws StartupError: the robots are in several
  /// worlds; the form, the result or the draft is there and cannot be read, or the result could not
  /// be written.
  TaskTopics(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
             const Clock& clock);

  /// Whether a participant's page is connected.
  void SetPresent(bool present) { present_ = present; }
  void Receive(const RobotState& state) { task_.Receive(state); }
  /// Whether a robot was resumed, which begins a maze.
  void Receive(const ControlRegistry& control);
  /// Keeps notes, counts paths.
  void Receive(const OperatorEvent& event);
  /// After these.
  void Step();

  std::string CheckAllowed(const OperatorRequest& request) const;
  /// Requires a FinishRequest. When only the reply cannot be stored, the maze is finished all the
  /// same.
  BeliefStore::Answer Finish(const OperatorRequest& request);
  OperatorReply Answer(const StudyRequest& request);

  /// Stops and resumes of pauses, which nobody else asks for.
  std::vector<OperatorRequest> TakeRequests() { return std::exchange(requests_, {}); }
  /// What changed for pages since the last call.
  std::vector<console::Update> TakeUpdates();
  /// Whether the step has finished since the last call.
  bool TakeFinished() { return std::exchange(just_finished_, false); }
  bool finished() const { return task_.phase() == TaskPhase::kFinished; }

  TaskStatus status() const;

 private:
  struct End {
    std::string event;  // as of StepEntry
    std::string reason;
    std::string answers;  // of a form
    std::optional<TaskResult> measured;
  };

  void AdoptResult(const nlohmann::ordered_json& result);
  void AdoptProgress();
  void Begin();
  void CountTime();
  /// Pages show time from here on.
  void StartShownTime();
  /// Why it is refused; empty = it is done.
  std::string Decide(const StudyRequest& request);
  std::string KeepDraft(const std::string& json);
  std::string TakeAnswers(const std::string& json);
  std::string SetPaused(bool paused);
  std::string Abort(const std::string& reason);
  Result<TaskResult> Measure() const;
  /// Ends the step, once its result is written.
  Result<void> Conclude(End end);
  nlohmann::ordered_json ResultOf(const End& end) const;
  void AddMaze(nlohmann::ordered_json& json, const End& end) const;
  Result<void> Save(StepProgress progress);
  void PublishMark(const std::string& label, const std::string& text = "",
                   double at_s = WallSeconds());
  std::string draft_file() const { return options_.result + ".draft"; }

  TaskOptions options_;
  std::string method_;
  std::size_t robots_ = 0;
  std::string world_;  // empty without robots
  BeliefStore& store_;
  const Clock& clock_;
  std::string client_;  // of its own requests
  std::uint64_t last_request_ = 0;
  std::vector<OperatorRequest> requests_;
  std::optional<bus::Subscriber<nav_msgs::msg::OccupancyGrid>> truth_;
  bus::Publisher<conav_msgs::msg::StudyMark> marks_;
  std::optional<StudyForm> form_;
  PageWords words_;
  ParticipantTask task_;
  StepProgress progress_;
  std::set<std::string> driving_;  // robots
  bool present_ = false;
  bool just_finished_ = false;
  bool aborted_ = false;
  double mapping_accuracy_ = 0.0;
  Clock::TimePoint counted_at_{};
  Clock::TimePoint save_due_at_{};
  Clock::TimePoint end_due_at_{};  // of one with a time limit
  double shown_used_s_ = 0.0;
  double shown_since_s_ = 0.0;
  std::optional<TaskStatus> shown_;
  std::optional<std::string> shown_answers_;
  std::size_t shown_entries_ = 0;
};

}  // namespace conav::operators
