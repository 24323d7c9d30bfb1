#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "common/grid/visibility.h"
#include "common/grid/wing.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "operator/simulated/path_planner.h"
#include "operator/simulated/snapshot_reader.h"
#include "operator/simulated/steering.h"

namespace conav::operators {

/// How long the person is occupied with an item before its edit and path are sent: simulation time,
/// log-normal with these means, fixed when log_sd is 0.
struct InteractionTimeParameters {
  double picture_s = 0.0;
  double blocked_s = 0.0;
  double path_s = 0.0;  // a first path, or another one for a robot that has come to its end
  double log_sd = 0.0;

  void Visit(ConfigReader& reader);
};

/// A person who knows how plans go wrong: a wing may be mirrored, or shifted by two cells. They compare
/// what pictures have shown with the map that they began with, and with each such explanation of it;
/// once one explains all but a quarter of at least kEvidence contradictions in a wing, they believe it.
/// Rule and numbers were fixed before anything was measured with them.
class WingInference {
 public:
  static constexpr int kEvidence = 4;

  explicit WingInference(BeliefGrid first) : first_(std::move(first)) {}

  /// What a picture shows. The wing as it must be when that is the first time that an explanation is
  /// believed, as edits of `belief`; else none.
  std::vector<CellEdit> See(const VisibleCells& visible, const BeliefGrid& belief);

 private:
  int Contradictions(const BeliefGrid& map, const Wing& wing) const;

  BeliefGrid first_;
  std::map<Cell, bool> seen_;  // whether the cell is a wall
  bool believes_ = false;
};

struct SyntheticOperatorParameters {
  SnapshotReaderParameters reader;
  PathPlannerParameters planner;
  /// As a teleoperator.
  SteeringParameters steering;
  /// Answers nothing and draws nothing.
  bool silent = false;
  /// Concludes from what pictures show that a wing of the map is wrong as a whole (WingInference), and
  /// corrects all of it.
  bool infers_wings = false;
  /// Marks goals that a picture shows, for robots that do not keep their goals themselves.
  bool marks_goals = false;
  /// Share of the pictures of a stream, four a second, that is looked at to correct the map.
  double glance_rate = 0.03;
  /// Wall time that passes before each answer.
  double thinking_time_s = 0.0;
  /// How long guidance holds, simulation time.
  double guidance_valid_s = 1800.0;
  /// A refused or unanswered request is repeated after a pause, so often; each pause is twice as
  /// long as the one before, up to 32 times the first. Wall time.
  double retry_pause_s = 0.1;
  int attempts = 50;
  /// How long an answer waits for a state or a picture that was announced but did not arrive. Wall
  /// time.
  double patience_s = 2.0;
  /// What comes next: "arrival" = in the order of arrival; "queue" = the first of the published
  /// attention queue that can be dealt with, selected there first. Then streamed pictures are
  /// looked at only while their robot is attended to.
  std::string order = "arrival";
  /// In the order "queue".
  InteractionTimeParameters interaction;

  void Visit(ConfigReader& visitor);
};

/// Kinds of people: "careful" (the defaults), "hasty" (overlooks much, guesses, plans to the next
/// goal only), "wrong" (on purpose: guesses only, and leads away from the goals), "silent".
const std::vector<std::string>& OperatorKinds();
/// `kind` is one of them (demanded).
SyntheticOperatorParameters ParametersOfKind(const std::string& kind);

/// What the person does next: a request to the operator service.
struct OperatorAsk {
  std::string world;
  SimTime stamp;
  /// Goals, an edit, guidance, a key, or (with order "queue" only) a selection.
  decltype(OperatorRequest::body) body;
};

/// One synthetic person who supervises several robots, one item after the other.
///
/// Receives what a console would show and decides what to ask of the operator service:
///   first path   when a robot's state and its world's belief are there: guidance, unasked.
///   picture      looks at it, marks goals that it shows (marks_goals), edits the map if it is wrong,
///                then ALWAYS gives guidance for it.
///   glance       a picture of a stream: now and then looks and edits; no guidance.
///   attention    after the pictures up to newest_snapshot: marks a blocked cell as a wall (which
///                the robot knows for certain; such a wall is remembered and never crossed or
///                removed again), then gives guidance. kSnapshot needs no answer besides the
///                picture's own.
/// An edit that is refused because the map changed meanwhile is made again on the new map, where it
/// is still a change.
///
/// One request is under way at a time: after Next() gave one, Answered() must follow before the
/// next.
/// Deterministic: each robot's pictures are read with random numbers of its own, in order, so that
/// the interleaving of robots does not matter. Wall time only decides when, never what, except
/// after patience_s. With the order "queue" that and the interaction times are ruled by simulation
/// time.
/// Pure; threads: not synchronised.
class SyntheticOperator {
 public:
  /// Items that wait. When a picture comes to more, the oldest picture is given up, as if it had been
  /// looked at.
  static constexpr std::size_t kMostWaiting = 500;

  SyntheticOperator(const SyntheticOperatorParameters& parameters, std::uint64_t seed,
                    const std::map<std::string, std::string>& world_of_robot);

  /// Messages of robots and worlds that are not this person's are ignored. A state older than the
  /// one before comes from a new run: the person starts again for this robot.
  void Receive(const Belief& belief);
  void Receive(const RobotState& state);
  void Receive(const Snapshot& snapshot, Clock::TimePoint now);
  void Receive(const AttentionRequest& attention, Clock::TimePoint now);
  /// Pictures that were answered before (by somebody else, or before a restart) are left alone.
  void Receive(const Guidance& guidance);
  /// Where the goals of a robot stand: what eyes find in its pictures.
  void ReceiveGoalObjects(const std::string& robot, std::vector<Position> objects);
  /// For the order "queue".
  void Receive(const AttentionQueueState& queue);
  /// The operator's time, which rules interaction times.
  void Receive(SimTime now) { operator_time_ = std::max(operator_time_, now); }

  /// What to ask now; nothing while a request is under way, while thinking, or without an occasion.
  std::optional<OperatorAsk> Next(Clock::TimePoint now);
  /// The end of the request under way: its reply, or an error when none came.
  void Answered(const Result<OperatorReply>& reply, Clock::TimePoint now);

  struct Counts {
    std::uint64_t snapshots = 0;  // looked at or glanced over
    std::uint64_t edits = 0;      // cells, accepted
    std::uint64_t guidance = 0;   // accepted
    std::uint64_t refused = 0;    // requests
    std::uint64_t given_up = 0;   // items left unfinished
    std::string newest_problem;   // reason of the newest refusal or failure
  };
  const Counts& counts() const { return counts_; }
  /// Items waiting or in work.
  std::size_t open() const { return queue_.size() + (current_ ? 1 : 0); }

 private:
  struct FirstPath {};
  struct Item {
    std::string robot;
    std::variant<FirstPath, Snapshot, AttentionRequest> occasion;
    Clock::TimePoint received_at{};
    bool looked = false;
    std::vector<CellEdit> edits{};  // still to be made
    std::vector<Cell> marks{};      // goals that are still to be given
    int attempts = 0;
    Clock::TimePoint not_before{};
    /// In the order "queue":
    AttentionReason reason = AttentionReason::kNone;
    bool selected = false;
    SimTime busy_until{};
  };
  struct Robot {
    std::string world;
    SnapshotReader reader;
    Random interaction_times;
    Random noticing;
    std::optional<RobotState> state;
    std::uint64_t received = 0;   // sequence number of the newest picture
    std::uint64_t looked_at = 0;  // sequence number of the newest picture that was dealt with
    std::uint64_t answered = 0;   // sequence number of the newest picture with guidance
    std::optional<AttentionRequest> attention;  // newest received
    std::optional<Snapshot> streamed;           // newest, with order "queue"
    std::vector<Position> goal_objects{};
    std::set<Cell> marked{};  // goals
  };
  struct World {
    std::optional<Belief> belief;
    std::uint64_t revision_needed = 0;  // of our own newest edit
    std::set<Cell> certain_walls;
    std::optional<WingInference> wings;
  };

  Robot* Find(const std::string& robot, const std::string& world);
  bool Ready(const Item& item, Clock::TimePoint now) const;
  bool ReadyForAttention(const Robot& robot, const AttentionRequest& attention) const;
  bool TakeUp(Clock::TimePoint now);
  bool FollowsQueue() const { return parameters_.order == "queue"; }
  /// The first of the published queue that can be dealt with; queue_.end() when there is none.
  std::deque<Item>::iterator FirstOfQueue(Clock::TimePoint now);
  SimTime BusyUntil(const Item& item);
  void Selected(const Result<OperatorReply>& reply, Clock::TimePoint now);
  std::vector<CellEdit> EditsFor(const Item& item);
  std::vector<CellEdit> MarkBlocked(const AttentionRequest& attention, const Robot& robot,
                                    World& world);
  /// With order "queue": what the newest streamed picture shows besides.
  void LookAtStream(Robot& robot, const World& world, std::vector<CellEdit>& edits);
  std::vector<Cell> MarksFor(const Item& item);
  std::optional<OperatorAsk> MarkAsk(const Item& item) const;
  std::optional<OperatorAsk> EditAsk(const Item& item) const;
  std::optional<OperatorAsk> GuideAsk(const Item& item);
  void Finish();

  SyntheticOperatorParameters parameters_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, World> worlds_;
  std::deque<Item> queue_;  // in the order of arrival
  std::optional<Item> current_;
  std::optional<AttentionQueueState> published_;  // newest
  std::uint64_t refused_at_ = 0;                  // revision of the queue at a refused selection
  SimTime operator_time_;
  std::optional<OperatorAsk> under_way_;
  bool asked_ = false;  // under_way_ was handed out
  Counts counts_;
};

}  // namespace conav::operators
