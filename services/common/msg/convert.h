#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/grid/frames.h"
#include "common/grid/visibility.h"
#include "common/msg/planner_lease.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "conav_msgs.h"
#include "ros2_interfaces.h"

/// The edge between the wire and the domain: generated IDL types stop here.
///
/// ToDomain checks everything that a foreign program could get wrong and rejects it (kMalformed)
/// with field, value and limit, for example "heading = nan is not finite". A returned value is
/// valid by construction. ToMessage cannot fail. Both are pure and safe to call concurrently.
///
/// Limits of all messages: see checks.h. Names of worlds and robots are [A-Za-z0-9_]; names
/// of clients may also contain . : @ / -.
namespace conav {

/// Whole simulation time from 0 to 2^31 s; ToMessage saturates there.
Result<SimTime> ToDomain(const builtin_interfaces::msg::Time& message);
builtin_interfaces::msg::Time ToMessage(SimTime time);
/// Frame "map".
std_msgs::msg::Header ToHeader(SimTime stamp);

/// Frame "map", origin in the middle of the grid. The message's rows run from south to north, ours
/// from north to south. -1 is unknown; of 0..100, values up to 25 are free, values from 65 are
/// occupied, as in nav2_map_server, and values between them are unknown. ToMessage writes -1, 0,
/// 100. The cell size passes through a float: 0.1 m comes back as 0.1f.
Result<MapUpdate> ToDomain(const nav_msgs::msg::OccupancyGrid& message);
nav_msgs::msg::OccupancyGrid ToMessage(const MapUpdate& map);
/// The operator's map for RViz: 0..100 = probability of a wall in percent.
nav_msgs::msg::OccupancyGrid ToOccupancyMessage(const Belief& belief);

/// A goal in frame "map" (RViz "2D Goal Pose"). Ignores its direction and stamp.
Result<Position> ToDomain(const geometry_msgs::msg::PoseStamped& message);

/// Cell centres, each pose turned towards the next one (the last like the one before it).
nav_msgs::msg::Path ToPathMessage(SimTime stamp, std::span<const Cell> path,
                                  const GridGeometry& geometry);
/// The positions of the poses, unchecked: they may lie off the map or be NaN.
std::vector<Position> ToPositions(const nav_msgs::msg::Path& message);

/// Width and height in [1, 16384] pixels, focal lengths k[0] and k[4] above 0, fields of view up to
/// 2.6 rad. Ignores distortion and principal point.
Result<CameraLens> ToDomain(const sensor_msgs::msg::CameraInfo& message);

/// Where a robot is and how it moves, in a frame of the floor.
struct RobotMotion {
  Position position;
  double heading_rad = 0.0;
  double forward_m_per_s = 0.0;
  double turn_rad_per_s = 0.0;
};
geometry_msgs::msg::Quaternion ToQuaternion(double yaw_rad);
geometry_msgs::msg::Quaternion ToQuaternion(const FramePose& pose);
/// `motion` in odom, of base_link.
nav_msgs::msg::Odometry ToOdometry(SimTime stamp, const RobotMotion& motion);
/// `robot`'s frame `child` in its frame `parent`, ids as FrameId.
geometry_msgs::msg::TransformStamped ToTransform(SimTime stamp, std::string_view robot,
                                                 std::string_view parent, std::string_view child,
                                                 const FramePose& pose);

// robot.h
Result<RobotCommand> ToDomain(const conav_msgs::msg::RobotCommand& message);
conav_msgs::msg::RobotCommand ToMessage(const RobotCommand& command);
Result<RobotState> ToDomain(const conav_msgs::msg::RobotState& message);
conav_msgs::msg::RobotState ToMessage(const RobotState& state);
Result<RobotGoals> ToDomain(const conav_msgs::msg::RobotGoals& message);
conav_msgs::msg::RobotGoals ToMessage(const RobotGoals& goals);
/// Takes the pixels of a message that is moved in; does not copy them.
Result<Snapshot> ToDomain(conav_msgs::msg::Snapshot message);
conav_msgs::msg::Snapshot ToMessage(const Snapshot& snapshot);

// supervision.h
Result<Belief> ToDomain(const conav_msgs::msg::BeliefMap& message);
conav_msgs::msg::BeliefMap ToMessage(const Belief& belief);
/// Rejects a path that is not 4-connected.
Result<Guidance> ToDomain(const conav_msgs::msg::Guidance& message);
conav_msgs::msg::Guidance ToMessage(const Guidance& guidance);
/// Checks what can be checked without the map. The operator service, which can reply, checks
/// whether the path is connected and the edits fit.
Result<OperatorRequest> ToDomain(const conav_msgs::msg::OperatorRequest& message);
conav_msgs::msg::OperatorRequest ToMessage(const OperatorRequest& request);
Result<DriveOrder> ToDomain(const conav_msgs::msg::DriveOrder& message);
conav_msgs::msg::DriveOrder ToMessage(const DriveOrder& order);
Result<StopOrder> ToDomain(const conav_msgs::msg::StopOrder& message);
conav_msgs::msg::StopOrder ToMessage(const StopOrder& order);
Result<OperatorReply> ToDomain(const conav_msgs::msg::OperatorReply& message);
conav_msgs::msg::OperatorReply ToMessage(const OperatorReply& reply);
Result<OperatorEvent> ToDomain(const conav_msgs::msg::OperatorEvent& message);
conav_msgs::msg::OperatorEvent ToMessage(const OperatorEvent& event);
Result<AttentionRequest> ToDomain(const conav_msgs::msg::AttentionRequest& message);
conav_msgs::msg::AttentionRequest ToMessage(const AttentionRequest& request);
Result<AttentionQueueState> ToDomain(const conav_msgs::msg::AttentionQueue& message);
conav_msgs::msg::AttentionQueue ToMessage(const AttentionQueueState& queue);

// planning.h
Result<SearchReport> ToDomain(const conav_msgs::msg::SearchReport& message);
conav_msgs::msg::SearchReport ToMessage(const SearchReport& report);
/// Only `client` and `request_id`: the addressee of the error when ToDomain rejects the request.
Result<PerceptionRequest> SenderOf(const conav_msgs::msg::PerceptionRequest& message);
/// Every cell must lie inside the grid. ToMessage requires beliefs of one shape.
Result<PerceptionRequest> ToDomain(const conav_msgs::msg::PerceptionRequest& message);
conav_msgs::msg::PerceptionRequest ToMessage(const PerceptionRequest& request);
/// The reply does not carry the shape of its grids: the client knows it.
Result<PerceptionReply> ToDomain(const conav_msgs::msg::PerceptionReply& message, int rows,
                                 int columns);
conav_msgs::msg::PerceptionReply ToMessage(const PerceptionReply& reply);

/// Each name occurs at most once among the robots and once among those held; lease epochs are at
/// least 1.
Result<PlannerLease> ToDomain(const conav_msgs::msg::PlannerLease& message);
conav_msgs::msg::PlannerLease ToMessage(const PlannerLease& lease);

Result<IntendedPath> ToDomain(const conav_msgs::msg::IntendedPath& message);
conav_msgs::msg::IntendedPath ToMessage(const IntendedPath& path);

/// For bus::Subscriber::TakeValid().
inline constexpr auto kToDomain = [](auto&& message) {
  return ToDomain(std::forward<decltype(message)>(message));
};

}  // namespace conav
