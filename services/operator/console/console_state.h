#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "operator/console/update_log.h"

namespace conav::operators {

/// The newest health of a process.
struct ServiceHealth {
  std::string name;
  console::Level level = console::LEVEL_OK;
  std::string message;
  bool operator==(const ServiceHealth&) const = default;
};

/// A person at the console.
struct Person {
  std::string client;
  std::string name;
  console::Role role = console::ROLE_OBSERVER;
  bool operator==(const Person&) const = default;
};

/// Folds what happens into the updates that pages show (idl/console.proto says which): live in the
/// operator service, from a recording in a replay.
///
/// A robot whose time goes back belongs to a new run of its world: the reports of that world's
/// robots are forgotten. The operator's work (map, guidance, the command log) is kept.
/// `received_s`, `now_s`: wall time, s since 1970, when something was sent, and the present. They
/// only decide how often something is passed on.
/// Threads: one caller; `log` may be read by others.
class ConsoleState {
 public:
  /// Of each robot; older ones are forgotten. A page that comes gets all of them, a kilobyte each.
  static constexpr std::size_t kSnapshotsKept = 20;
  static constexpr std::size_t kEventsKept = 500;
  /// Alerts that are over and acknowledged.
  static constexpr std::size_t kAlertsKept = 200;
  /// Cells of each robot's trail, in pieces.
  static constexpr std::size_t kTrailPiece = 64;
  static constexpr std::size_t kTrailPiecesKept = 16;

  /// `log` outlives it.
  ConsoleState(UpdateLog& log, console::Session session);

  void Receive(const RobotState& state, double received_s);
  void ReceiveSeen(const std::string& robot, const std::string& world, const MapUpdate& map);
  void ReceiveGeometry(const std::string& world, const MapUpdate& map);
  void ReceiveTruth(const std::string& world, const OccupancyGrid& truth);
  /// `initial`: revision 0 of it.
  void Receive(const Belief& belief, const BeliefGrid& initial);
  void Receive(const Guidance& guidance);
  void ReceivePlan(const std::string& robot, SimTime stamp, const std::vector<Cell>& cells);
  void Receive(const SearchReport& report);
  /// A snapshot that is not streamed, without an answer.
  void Receive(console::Snapshot snapshot);
  /// The newest picture of `robot` counts as if it had come then: a replay's time goes on
  /// otherwise.
  void ReceiveSnapshotAgain(const std::string& robot, double now_s);
  /// What the model expects the operator to do with the picture of that number.
  void Receive(const std::string& robot, const std::string& world, std::uint64_t snapshot,
               const std::string& model, const PerceptionAnswer& answer);
  /// "Nothing new here".
  void ReceiveAnswer(const std::string& robot, std::uint64_t snapshot, const std::string& client);
  void Receive(const AttentionQueueState& queue);
  void ReceiveGoalPose(const std::string& robot, Cell cell, double stamp_s);
  void Receive(const ServiceHealth& health, double now_s);
  void Receive(const std::vector<Person>& people);
  void Receive(console::Event event);
  void Receive(console::Control control);
  void Receive(const console::Alert& alert);
  void Receive(const console::Playback& playback);
  /// Of a step: its task, form, draft or log, one for all.
  void ReceiveStep(console::Update update);

  /// Forgets all but the session.
  void Reset();

  const console::Session& session() const { return session_; }
  SimTime TimeOf(const std::string& world) const;

 private:
  struct RobotMemory {
    std::string world;
    SimTime stamp;
    std::uint64_t cell_moves = 0;
    std::vector<Cell> trail;                      // its last piece
    std::size_t trail_before = 0;                 // cells of the pieces before
    std::string seen;                             // the newest map, packed
    std::optional<console::Snapshot> unanswered;  // the newest, while nobody answered it
    std::optional<console::Snapshot> newest_snapshot;
    /// The newest picture that was answered; it may come after its answer, when the service starts.
    std::uint64_t answered = 0;
    console::SnapshotAnswer answer = console::ANSWER_NONE;
    std::string answered_by;
  };
  struct WorldMemory {
    console::World world;
    SimTime stamp;
    double sent_at_s = 0.0;
  };

  /// `world` by value: callers name it by what this erases.
  void StartNewRun(std::string world);
  void PutSession();
  void ExtendTrail(RobotMemory& memory, const RobotState& state);
  /// The piece of the trail that begins with its cell number `first`.
  void PutTrail(const std::string& robot, std::size_t first, std::span<const Cell> cells);
  void NoteTime(const RobotState& state, double received_s);
  void PutSnapshot(const console::Snapshot& snapshot);
  /// All pictures up to `snapshot`, which was answered so.
  void Answered(const std::string& robot, std::uint64_t snapshot, console::SnapshotAnswer answer,
                const std::string& by);
  static void Close(console::Snapshot& snapshot, const RobotMemory& memory);

  UpdateLog& log_;
  console::Session session_;
  std::map<std::string, RobotMemory> robots_;
  std::map<std::string, WorldMemory> worlds_;
  std::map<std::string, ServiceHealth> services_;
  std::map<std::string, double> service_sent_at_s_;
  std::uint64_t last_event_ = 0;
};

}  // namespace conav::operators
