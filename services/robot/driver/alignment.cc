#include "robot/driver/alignment.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace conav::robot {
namespace {

/// Points that lie closer together than this say nothing about a direction.
constexpr double kLeastSpreadM = 0.1;

Position Middle(std::span<const PointPair> pairs, Position PointPair::*point) {
  Position sum;
  for (const PointPair& pair : pairs) {
    sum.x_m += (pair.*point).x_m;
    sum.y_m += (pair.*point).y_m;
  }
  const auto count = static_cast<double>(pairs.size());
  return {sum.x_m / count, sum.y_m / count};
}

}  // namespace

Position operator*(const Pose& frame, Position place) {
  const double cosine = std::cos(frame.heading_rad);
  const double sine = std::sin(frame.heading_rad);
  return {frame.position.x_m + cosine * place.x_m - sine * place.y_m,
          frame.position.y_m + sine * place.x_m + cosine * place.y_m};
}

Pose operator*(const Pose& frame, const Pose& pose) {
  return {frame * pose.position, WrapAngle(frame.heading_rad + pose.heading_rad)};
}

Pose Inverse(const Pose& pose) {
  const Pose turned{{}, -pose.heading_rad};
  return {turned * Position{-pose.position.x_m, -pose.position.y_m}, -pose.heading_rad};
}

Result<Alignment> AlignByPairs(std::span<const PointPair> pairs, double most_residual_m) {
  if (pairs.size() < 3) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} pairs of points; three are needed", pairs.size()));
  }
  const Position robot_middle = Middle(pairs, &PointPair::robot);
  const Position plan_middle = Middle(pairs, &PointPair::plan);
  double along = 0.0;   // sum of the dot products of both sides' arms
  double across = 0.0;  // of their cross products
  double spread_m = 0.0;
  for (const PointPair& pair : pairs) {
    const Position a{pair.robot.x_m - robot_middle.x_m, pair.robot.y_m - robot_middle.y_m};
    const Position b{pair.plan.x_m - plan_middle.x_m, pair.plan.y_m - plan_middle.y_m};
    along += a.x_m * b.x_m + a.y_m * b.y_m;
    across += a.x_m * b.y_m - a.y_m * b.x_m;
    spread_m = std::max(spread_m, std::hypot(a.x_m, a.y_m));
  }
  if (!std::isfinite(along) || !std::isfinite(across) || spread_m < kLeastSpreadM) {
    return Fail(ErrorCode::kInvalidArgument, "the points coincide, or are no numbers");
  }
  Alignment alignment;
  alignment.plan_from_robot.heading_rad = std::atan2(across, along);
  const Position turned = alignment.plan_from_robot * robot_middle;
  alignment.plan_from_robot.position = {plan_middle.x_m - turned.x_m, plan_middle.y_m - turned.y_m};
  std::size_t worst = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double off_m = Distance(alignment.plan_from_robot * pairs[i].robot, pairs[i].plan);
    if (off_m < alignment.residual_m) continue;
    alignment.residual_m = off_m;
    worst = i;
  }
  if (alignment.residual_m > most_residual_m) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("pair {} is {:.2f} m off the best fit; the limit is {} m", worst + 1,
                            alignment.residual_m, most_residual_m));
  }
  return alignment;
}

}  // namespace conav::robot
