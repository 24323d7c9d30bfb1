#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "common/grid/grid.h"
#include "common/msg/robot.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"

/// Domain values of the operator's side of the bus; idl/conav_msgs states who sends them
/// and when.
namespace conav {

/// The operator's map. Revision 0 is the initial one; each accepted edit adds one.
struct Belief {
  SimTime stamp;
  std::string world;
  std::uint64_t revision = 0;
  BeliefGrid wall_probability;
  std::string edited_by;
  double cell_size_m = 2.0;
  Position middle{};  // of the grid, in the map frame

  GridGeometry geometry() const {
    return {wall_probability.rows(), wall_probability.columns(), cell_size_m, middle};
  }
  bool operator==(const Belief&) const = default;
};

/// The path that the operator suggests to a robot; an empty path withdraws it.
struct Guidance {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t revision = 0;
  std::vector<Cell> path;
  std::string given_by;
  std::uint64_t belief_revision = 0;
  /// Newest picture that this or earlier guidance answered; Snapshot::sequence_number, 0 = none.
  std::uint64_t answers_snapshot = 0;
  SimTime valid_until;
  bool operator==(const Guidance&) const = default;
};

struct CellEdit {
  Cell cell;
  bool wall = false;
  bool operator==(const CellEdit&) const = default;
};

struct EditRequest {
  std::uint64_t base_revision = 0;
  std::vector<CellEdit> edits;
  bool operator==(const EditRequest&) const = default;
};

struct GuideRequest {
  std::string robot;
  std::vector<Cell> path;
  std::uint64_t answers_snapshot = 0;
  double valid_for_s = 0.0;
  bool operator==(const GuideRequest&) const = default;
};

/// One low-level action for `robot`, to be carried out before `expires_at`.
struct DriveRequest {
  std::string robot;
  DriveAction drive = DriveAction::kStop;
  SimTime expires_at;
  bool operator==(const DriveRequest&) const = default;
};

/// A DriveRequest that the operator service passes on to the planner.
struct DriveOrder {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t sequence_number = 0;  // rises with each order of a robot
  DriveAction drive = DriveAction::kStop;
  std::string given_by;
  SimTime expires_at;
  bool operator==(const DriveOrder&) const = default;
};

/// Why something needs the operator. Robots send the first four, and kNone to withdraw; the
/// operator service detects the rest.
enum class AttentionReason : std::uint8_t {
  kNone = 0,
  kSnapshot = 1,
  kBlocked = 2,
  kNoGuidance = 3,
  kFirstPath = 4,
  kCommandFailed = 5,
  kLinkLost = 6,
  kGoalsReached = 7,
};

/// The operator selects an item of the attention queue.
struct SelectRequest {
  std::string robot;
  AttentionReason reason = AttentionReason::kSnapshot;
  bool operator==(const SelectRequest&) const = default;
};

/// The operator looked at a picture and found nothing new: the robot's path stays as it is.
struct AnswerRequest {
  std::string robot;
  std::uint64_t snapshot = 0;  // Snapshot::sequence_number
  bool operator==(const AnswerRequest&) const = default;
};

/// Stops `robots` until a ResumeRequest; none = all robots. The requests below read an empty list the
/// same way.
struct StopRequest {
  std::vector<std::string> robots;
  std::string reason;
  bool operator==(const StopRequest&) const = default;
};

struct ResumeRequest {
  std::vector<std::string> robots;
  bool operator==(const ResumeRequest&) const = default;
};

/// Only this client commands `robots` from now on; taking over from another client requires a
/// reason. With `ask` it only asks the client that has control, which releases the robots or keeps
/// them by taking control again.
struct TakeControlRequest {
  std::vector<std::string> robots;
  std::string reason;
  bool ask = false;
  bool operator==(const TakeControlRequest&) const = default;
};

/// With `to_client` refused unless that client asks for all of them.
struct ReleaseControlRequest {
  std::vector<std::string> robots;
  std::string to_client;
  bool operator==(const ReleaseControlRequest&) const = default;
};

struct AcknowledgeRequest {
  std::uint64_t alert = 0;
  bool operator==(const AcknowledgeRequest&) const = default;
};

struct ShelveRequest {
  std::uint64_t alert = 0;
  double duration_s = 0.0;  // wall time
  bool operator==(const ShelveRequest&) const = default;
};

/// Adds goals to those that `robot` has left, and removes those left in the cells that hold the places
/// `remove`. Only for robots whose goals the operator service keeps.
struct GoalsRequest {
  std::string robot;
  std::vector<Position> add;
  std::vector<Position> remove;
  bool operator==(const GoalsRequest&) const = default;
};

/// A participant is done with the task; only valid while the operator service runs one.
struct FinishRequest {
  bool operator==(const FinishRequest&) const = default;
};

/// A note about this moment, for the command log.
struct NoteRequest {
  std::string text;
  bool operator==(const NoteRequest&) const = default;
};

/// A robot does not count a stop's revision, a command's sequence number or a lease epoch that is
/// further ahead of the newest it has: from the end of the range there is no way on.
inline constexpr std::uint64_t kMaxCounterStep = 1'000'000;

/// Whether `robot` must stand still, overriding all other commands.
struct StopOrder {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t revision = 0;
  bool stopped = false;
  std::string given_by;
  std::string reason;
  bool operator==(const StopOrder&) const = default;
};

/// A request of any client to the operator service. (client, request_id) makes a repeat harmless.
struct OperatorRequest {
  SimTime stamp;
  std::string client;
  std::uint64_t request_id = 0;
  std::string world;
  std::variant<EditRequest, GuideRequest, DriveRequest, SelectRequest, AnswerRequest, StopRequest,
               ResumeRequest, TakeControlRequest, ReleaseControlRequest, AcknowledgeRequest,
               ShelveRequest, FinishRequest, GoalsRequest, NoteRequest>
      body;
  bool operator==(const OperatorRequest&) const = default;
};

/// What a request asks for: OPERATOR_REQUEST_* of the bus, in the order of OperatorRequest::body.
enum class RequestKind : std::uint8_t {
  kEdit = 1,
  kGuide = 2,
  kDrive = 3,
  kSelect = 4,
  kAnswer = 5,
  kStop = 6,
  kResume = 7,
  kTakeControl = 8,
  kReleaseControl = 9,
  kAcknowledge = 10,
  kShelve = 11,
  kFinish = 12,
  kGoals = 13,
  kNote = 14,
};

inline RequestKind KindOf(const OperatorRequest& request) {
  static_assert(std::variant_size_v<decltype(request.body)> ==
                static_cast<std::size_t>(RequestKind::kNote));
  return static_cast<RequestKind>(request.body.index() + 1);
}

struct OperatorReply {
  std::string client;
  std::uint64_t request_id = 0;
  bool accepted = false;
  std::string reason;
  std::uint64_t revision = 0;
  bool operator==(const OperatorReply&) const = default;
};

/// A line of the command log: what a client asked for, and what the operator service decided.
struct OperatorEvent {
  SimTime stamp;  // of the world
  RequestKind kind = RequestKind::kNote;
  bool accepted = true;
  std::string client;
  std::string world;        // empty = none
  std::string robot;        // empty = none, or several
  std::string text;         // for people
  std::uint32_t cells = 0;  // edit: in the request; guide: of the path
  std::uint64_t revision = 0;
  bool operator==(const OperatorEvent&) const = default;
};

/// `request` when its names, sizes and ranges are valid; for requests from the bus and from pages.
/// The operator service, which can reply, checks whether a path is connected and edits fit. Errors:
/// kMalformed names the field, the value and the limit.
[[nodiscard]] Result<OperatorRequest> Checked(OperatorRequest request);

/// The reply that refuses `request`.
OperatorReply Refusal(const OperatorRequest& request, std::string reason,
                      std::uint64_t revision = 0);

struct AttentionRequest {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t sequence_number = 0;
  AttentionReason reason = AttentionReason::kSnapshot;
  Cell cell;
  std::uint64_t newest_snapshot = 0;  // Snapshot::sequence_number of this robot when it asked
  double value_lost_per_s = 0.0;
  double expected_information = 0.0;
  // When the robot continues without an answer. At most one is set; both 0 = it waits forever.
  SimTime gives_up_at{};
  double gives_up_after_s = 0.0;  // wall time since the request
  bool operator==(const AttentionRequest&) const = default;
};

/// One line of the attention queue.
struct AttentionItem {
  std::string world;
  std::string robot;
  AttentionReason reason = AttentionReason::kSnapshot;
  std::uint8_t tier = 1;  // 1 = first
  SimTime since;
  SimTime deadline;               // 0 = none in the operator's time
  double gives_up_after_s = 0.0;  // wall time since the request; 0 = none by the wall clock
  Cell cell;
  std::uint64_t newest_snapshot = 0;
  std::uint64_t source_sequence = 0;
  double value_lost_per_s = 0.0;
  double expected_information = 0.0;
  double expected_interaction_s = 0.0;
  double score = 0.0;
  std::string selected_by;
  bool operator==(const AttentionItem&) const = default;
};

/// How busy the operator is, in seconds of the operator's time; see AttentionQueue in idl/conav_msgs.
struct OperatorWorkload {
  std::uint32_t robots = 0;
  std::uint64_t interactions = 0;
  std::uint64_t abandoned = 0;
  double observed_s = 0.0;
  double busy_s = 0.0;
  double interaction_time_s = 0.0;
  double neglect_time_s = 0.0;
  double waiting_time_s = 0.0;
  double waiting_time_p95_s = 0.0;
  double value_lost = 0.0;
  double utilisation = 0.0;
  double attended_robots = 0.0;
  double fan_out = 0.0;
  double fan_out_with_waits = 0.0;
  double predicted_utilisation = 0.0;
  double predicted_waiting_time_s = 0.0;
  bool operator==(const OperatorWorkload&) const = default;
};

/// The attention queue, highest priority first, and the operator's workload.
struct AttentionQueueState {
  SimTime stamp;
  std::uint64_t revision = 0;
  std::string order;
  std::vector<AttentionItem> items;
  OperatorWorkload workload;
  bool operator==(const AttentionQueueState&) const = default;
};

}  // namespace conav
