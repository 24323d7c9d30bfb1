#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "common/bus/topics.h"

/// Every topic of topics.h once more, as lists: for those who handle all of them alike, such as the
/// recorder. A test compares the two files.
namespace conav::bus {

inline constexpr std::tuple kRobotTopics{kRobotMap,     kOdometry,     kTransforms, kRobotState,
                                         kRobotCommand, kCameraImage,  kCameraInfo, kSnapshot,
                                         kGuidance,     kDriveOrder,   kHoldOrder,  kGoalPose,
                                         kPlan,         kSearchReport, kAttention,  kRobotWay};

inline constexpr std::tuple kWorldTopics{kBelief, kBeliefMap, kInitialMap, kTruth, kGoals};

inline constexpr std::tuple kSystemTopics{kOperatorRequest, kOperatorReply,     kPlannerLease,
                                          kAttentionQueue,  kPerceptionRequest, kPerceptionReply,
                                          kClock,           kDiagnostics,       kRosout};

/// Patterns of the topics that carry one picture after the other, many times the bytes of all
/// others.
inline constexpr std::array kStreamPatterns{kCameraImage.pattern};

/// Calls visit(topic) for each topic of one of the lists.
template <class Topics, class Visit>
void ForEachTopic(const Topics& topics, Visit&& visit) {
  std::apply([&](const auto&... topic) { (visit(topic), ...); }, topics);
}

}  // namespace conav::bus
