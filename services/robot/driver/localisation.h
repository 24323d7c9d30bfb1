#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/runtime/clock.h"
#include "robot/driver/alignment.h"

namespace conav::robot {

/// The newest transform of each frame in its parent, as TF and odometry tell them.
class FrameTree {
 public:
  struct Edge {
    std::string parent;
    Pose pose;  // of the frame in its parent
    Clock::TimePoint received;
    bool fixed = false;  // from tf_static: never out of date
  };
  /// `frame` in the frame at the top; a leading '/' of frame ids does not count.
  struct Found {
    Pose pose;
    std::optional<Clock::TimePoint> motion;      // when the edge nearest to `frame` came that moves
    std::optional<Clock::TimePoint> correction;  // the oldest of the others that move
  };

  void Set(const std::string& frame, Edge edge);
  /// Nothing where no chain of parents leads from `frame` to `top`.
  std::optional<Found> Find(const std::string& top, const std::string& frame) const;

 private:
  std::map<std::string, Edge> edges_;
};

/// Whether the place of the robot can be trusted.
///
/// It is lost while its odometry or the correction of its map is silent for too long, and for
/// `settle_s` after a jump, which is a change that the robot cannot have driven.
class Localisation {
 public:
  struct Options {
    double timeout_s = 1.0;             // of odometry
    double correction_timeout_s = 5.0;  // of map -> odom
    double jump_m = 0.5;
    double jump_rad = 0.6;
    double settle_s = 2.0;
    double top_speed_mps = 1.0;
    double top_turn_rps = 2.0;
  };
  explicit Localisation(const Options& options) : options_(options) {}

  /// Call often. `found`: the robot in the frame of its map, if there is a chain of frames.
  void Step(const std::optional<FrameTree::Found>& found, Clock::TimePoint now);

  /// The newest place, also of a robot that is lost; nothing before the first.
  const std::optional<Pose>& pose() const { return pose_; }
  /// Why the place cannot be trusted, for people; empty if it can.
  const std::string& problem() const { return problem_; }
  int jumps() const { return jumps_; }

 private:
  Options options_;
  std::optional<Pose> pose_;
  Clock::TimePoint moved_at_{};  // when pose_ was received
  std::optional<Clock::TimePoint> unsettled_until_;
  std::string jump_;
  std::string problem_ = "localisation: no odometry yet";
  int jumps_ = 0;
};

}  // namespace conav::robot
