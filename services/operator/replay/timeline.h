#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/grid/geometry.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "operator/belief/alert.h"
#include "operator/console/console_state.h"
#include "operator/gateway/snapshot_store.h"
#include "operator/supervision/alerts.h"

/// What a console receives of a run, one value for each message or conclusion.
namespace conav::operators {

struct SeenMap {
  std::string robot;
  std::string world;
  MapUpdate map;
};
/// The map that the operator began with: it gives the size of the world.
struct InitialMap {
  std::string world;
  MapUpdate map;
};
struct TrueMap {
  std::string world;
  MapUpdate map;
};
struct ReceivedBelief {
  Belief belief;
  std::shared_ptr<const BeliefGrid> initial;
};
struct PlannedPath {
  std::string robot;
  SimTime stamp;
  std::vector<Cell> cells;
};
struct GoalSet {
  std::string robot;
  Cell cell;
  SimTime stamp;
};
/// "Nothing new here"; before the guidance that the operator service made of it.
struct SnapshotAnswered {
  std::string robot;
  std::uint64_t snapshot = 0;
  std::string client;
};
struct StreamFrame {
  std::string robot;
  SimTime stamp;
  std::vector<std::uint8_t> jpeg;
};
/// Times of an alert: positions in the recording, s.
using Received =
    std::variant<RobotState, SeenMap, InitialMap, TrueMap, ReceivedBelief, Guidance, PlannedPath,
                 GoalSet, SearchReport, Snapshot, SnapshotAnswered, StreamFrame,
                 AttentionQueueState, StopOrder, ServiceHealth, Alert, console::Event>;

/// Something that was received.
struct Moment {
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

  double position_s = 0.0;
  /// Number of a later moment that replaces this one: a seek beyond it skips this one.
  std::size_t replaced_by = kNever;
  Received value;
};

/// A recorded run, all of it. Positions: s since its beginning.
struct Timeline {
  console::Session session;
  double began_s = 0.0;  // wall time of position 0, s since 1970
  double duration_s = 0.0;
  std::vector<Moment> moments;  // by position
  std::vector<console::Mark> marks;
};

/// Makes a timeline of the recorded messages, and of the alerts, which the operator service concluded
/// from them and did not publish.
///
/// It begins with the first thing of a world or a robot, behind the start of the processes.
/// Positions go on with the wall time of the recording; where simulation time went on quicker, as
/// in a run without a page, with that: it is played as quickly as the robots believed to move.
/// `wall_s`: s since 1970, when it was recorded.
/// Threads: one.
class TimelineBuilder {
 public:
  explicit TimelineBuilder(console::Session session);

  void Receive(double wall_s, RobotState state);
  void ReceiveSeen(double wall_s, const std::string& robot, MapUpdate map);
  void ReceiveInitialMap(double wall_s, const std::string& world, MapUpdate map);
  void ReceiveTruth(double wall_s, const std::string& world, MapUpdate truth);
  void Receive(double wall_s, Belief belief);
  void Receive(double wall_s, Guidance guidance);
  /// Dropped while the size of the robot's world is not known, as GoalPose.
  void ReceivePlan(double wall_s, const std::string& robot, SimTime stamp,
                   const std::vector<Position>& positions);
  void ReceiveGoalPose(double wall_s, const std::string& robot, Position goal);
  void Receive(double wall_s, SearchReport report);
  void Receive(double wall_s, Snapshot snapshot);
  void ReceiveFrame(double wall_s, StreamFrame frame);
  void Receive(double wall_s, AttentionQueueState queue);
  void Receive(double wall_s, StopOrder order);
  void Receive(double wall_s, ServiceHealth health);
  void Receive(double wall_s, const OperatorEvent& event);

  Timeline Finish() &&;

 private:
  struct RobotMemory {
    std::string world;
    SimTime stamp;
    std::uint64_t cell_moves = 0;
    std::size_t goals_reached = 0;
    bool reported = false;
    std::optional<Guidance> guidance;
    bool lost = false;  // the attention queue once said so
  };
  struct WorldMemory {
    std::optional<GridGeometry> geometry;
    std::shared_ptr<const BeliefGrid> initial;
    std::optional<Belief> belief;
    /// Simulation time and position from which on the two are compared.
    std::optional<SimTime> stamp;
    double position_s = 0.0;
    SimTime newest;
  };
  struct Replaceable {
    std::size_t moment = 0;
    bool is = false;
  };
  struct ProcessMemory {
    ServiceHealth health;
    double wall_s = 0.0;
  };

  void MoveTo(double wall_s);
  /// The same, but it does not begin the recording.
  void Follow(double wall_s);
  void MoveWith(const RobotState& state);
  std::size_t Add(Received value);
  /// `replaceable`: void as soon as the next one of `group` is added.
  void Add(const std::string& group, bool replaceable, Received value);
  void Mark(console::MarkKind kind, const std::string& robot, std::string text);
  void UpdateAlerts(double wall_s);
  void CheckSilence(double wall_s);
  std::vector<RobotCondition> RobotConditions() const;

  Timeline timeline_;
  std::optional<double> first_wall_s_;
  double position_s_ = 0.0;
  std::map<std::string, Replaceable> groups_;
  std::map<std::string, RobotMemory> robots_;
  std::map<std::string, WorldMemory> worlds_;
  std::map<std::string, ProcessMemory> processes_;
  std::vector<AttentionItem> items_;
  AlertRegistry alerts_;
  std::map<std::uint64_t, std::uint32_t> alert_counts_;
};

struct RecordedRun {
  Timeline timeline;
  std::string name;
  /// What could not be read, in words: a file that was cut off, damaged chunks, messages that are
  /// not what their topic carries. The rest is in the timeline.
  std::vector<std::string> warnings;
};

/// Reads all that a console shows of the MCAP file `file`, which a conav recorder wrote. Pictures
/// and streams stay in memory. Errors: those of bag::McapReader::Open; kMalformed: not from a conav
/// recorder, or nothing in it.
[[nodiscard]] Result<RecordedRun> ReadRun(const std::filesystem::path& file);

/// Plays a timeline as if the console received it now.
///
/// Pages know wall time only: a value is as old for them as it is at this position of the
/// recording, also while it pauses or runs quicker. `now_s`: wall time, s since 1970.
/// Threads: one caller; what it fills may be read by others.
class ReplayPlayer {
 public:
  static constexpr double kFastest = 32.0;

  struct Shared {
    UpdateLog& updates;
    FrameSlots& frames;
    SnapshotStore& snapshots;
  };

  /// Pauses at the beginning. Both outlive it.
  ReplayPlayer(const Timeline& timeline, Shared shared, double now_s);

  /// `elapsed_s` of wall time have passed. Pauses at the end.
  void Advance(double elapsed_s, double now_s);
  /// Either may be missing or not a number. Pages get what differs when it goes ahead, and
  /// everything again when it goes back.
  void Seek(std::optional<double> position_s, std::optional<double> speed, double now_s);
  /// The people at its pages.
  void Receive(std::vector<Person> people);

  double position_s() const { return position_s_; }
  /// Recorded seconds per second; 0 = paused.
  double speed() const { return speed_; }

 private:
  struct Play;  // passes one moment to the state

  void MoveTo(double position_s, double now_s);
  void Reset();
  /// Sends values with an age again, where pages count it wrongly by now.
  void Refresh(double now_s);
  void PutPlayback(double now_s);
  double ReceivedAt(double position_s, double now_s) const {
    return now_s - (position_s_ - position_s);
  }

  const Timeline& timeline_;
  Shared shared_;
  ConsoleState state_;
  std::vector<Person> people_;
  double position_s_ = 0.0;
  double speed_ = 0.0;
  std::size_t next_ = 0;     // moment
  double age_zero_s_ = 0.0;  // wall time of position 0, as pages know it
  double playback_sent_at_s_ = 0.0;
  /// Numbers of the newest moments, by robot, process and alert.
  std::map<std::string, std::size_t> states_;
  std::map<std::string, std::size_t> snapshots_;
  std::map<std::string, std::size_t> frames_;
  std::map<std::string, std::size_t> processes_;
  std::map<std::uint64_t, std::size_t> alerts_;
};

}  // namespace conav::operators
