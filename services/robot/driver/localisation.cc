#include "robot/driver/localisation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace conav::robot {
namespace {

constexpr int kMostFrames = 32;  // of a chain: a longer one goes round

std::string Plain(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

double SecondsBetween(Clock::TimePoint from, Clock::TimePoint to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void FrameTree::Set(const std::string& frame, Edge edge) {
  edge.parent = Plain(edge.parent);
  edges_[Plain(frame)] = std::move(edge);
}

std::optional<FrameTree::Found> FrameTree::Find(const std::string& top,
                                                const std::string& frame) const {
  Found found;
  std::string at = Plain(frame);
  for (int i = 0; at != Plain(top); ++i) {
    const auto edge = edges_.find(at);
    if (edge == edges_.end() || i == kMostFrames) return std::nullopt;
    found.pose = edge->second.pose * found.pose;
    at = edge->second.parent;
    if (edge->second.fixed) continue;
    const Clock::TimePoint received = edge->second.received;
    if (!found.motion) {
      found.motion = received;
    } else {
      found.correction = std::min(found.correction.value_or(received), received);
    }
  }
  return found;
}

void Localisation::Step(const std::optional<FrameTree::Found>& found, Clock::TimePoint now) {
  if (!found || !found->motion) {
    problem_ = pose_ ? "localisation: its frames no longer lead to the map"
                     : "localisation: no chain of frames from the map to the robot yet";
    return;
  }
  if (!pose_ || *found->motion != moved_at_ || found->pose != *pose_) {
    if (pose_) {
      const double seconds = std::max(0.0, SecondsBetween(moved_at_, *found->motion));
      const double way_m = Distance(pose_->position, found->pose.position);
      const double turn_rad = std::abs(WrapAngle(found->pose.heading_rad - pose_->heading_rad));
      if (way_m > options_.jump_m + options_.top_speed_mps * seconds ||
          turn_rad > options_.jump_rad + options_.top_turn_rps * seconds) {
        ++jumps_;
        jump_ = fmt::format("localisation: jumped by {:.1f} m, {:.0f} degrees", way_m,
                            turn_rad * 57.29577951308232);
        unsettled_until_ = now + Seconds(options_.settle_s);
      }
    }
    pose_ = found->pose;
    moved_at_ = *found->motion;
  }
  problem_.clear();
  if (SecondsBetween(*found->motion, now) > options_.timeout_s) {
    problem_ = fmt::format("localisation: odometry silent for over {} s", options_.timeout_s);
  } else if (found->correction &&
             SecondsBetween(*found->correction, now) > options_.correction_timeout_s) {
    problem_ = fmt::format("localisation: the map's correction silent for over {} s",
                           options_.correction_timeout_s);
  } else if (unsettled_until_ && now < *unsettled_until_) {
    problem_ = jump_;
  }
}

}  // namespace conav::robot
