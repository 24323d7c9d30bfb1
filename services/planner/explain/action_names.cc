#include "planner/explain/action_names.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "common/grid/geometry.h"

namespace conav::planner {
namespace {

constexpr double kSameRad = 1e-6;

std::string StepName(Cell step) {
  constexpr std::array kNames{"north", "east", "south", "west"};  // as kNeighbourOffsets
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNeighbourOffsets[i] == step) return fmt::format("{} ", kNames[i]);
  }
  return "";
}

}  // namespace

std::string HeadingName(double heading_rad) {
  constexpr std::array kNames{"east", "north-east", "north", "north-west",
                              "west", "south-west", "south", "south-east"};
  constexpr double kEighth = std::numbers::pi / 4.0;
  const auto eighth = static_cast<int>(std::lround(heading_rad / kEighth));
  if (std::abs(WrapAngle(heading_rad - eighth * kEighth)) < kSameRad) {
    return kNames[static_cast<std::size_t>((eighth % 8 + 8) % 8)];
  }
  return fmt::format("{:.0f} degrees", heading_rad * 180.0 / std::numbers::pi);
}

std::string ActionName(const SearchAction& action, Cell robot) {
  if (action.kind == CommandKind::kTransmitView) {
    return fmt::format("picture to the {}", HeadingName(action.heading_rad));
  }
  if (action.kind == CommandKind::kDrive) return "low-level action";
  return fmt::format("move {}to {}", StepName(action.target - robot), action.target);
}

bool IsSameCommand(const SearchAction& a, const SearchAction& b) {
  if (a.kind != b.kind) return false;
  if (a.kind == CommandKind::kMove) return a.target == b.target;
  return std::abs(WrapAngle(a.heading_rad - b.heading_rad)) < kSameRad;
}

}  // namespace conav::planner
