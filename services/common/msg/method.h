#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "common/runtime/named.h"

namespace conav {

/// How a robot is supervised (docs/methods.md).
enum class MethodKind {
  kIgMcts,       // searches, and sends pictures that are worth the operator's attention
  kInstruction,  // follows the operator's path, asks where it is blocked
  kTeleop,       // the operator drives it
  kGreedy,       // explores without an operator
  kMapping,      // the mapping task: follows a fixed tour; the only method that gets the true map
};

inline constexpr std::array kMethods{MethodKind::kIgMcts, MethodKind::kInstruction,
                                     MethodKind::kTeleop, MethodKind::kGreedy,
                                     MethodKind::kMapping};
/// Those that drive to goals.
inline constexpr std::array kDemoMethods{MethodKind::kIgMcts, MethodKind::kInstruction,
                                         MethodKind::kTeleop, MethodKind::kGreedy};

/// As in configurations, reports and recordings.
constexpr std::string_view Name(MethodKind method) {
  switch (method) {
    case MethodKind::kIgMcts:
      return "ig-mcts";
    case MethodKind::kInstruction:
      return "instruction";
    case MethodKind::kTeleop:
      return "teleop";
    case MethodKind::kGreedy:
      return "greedy";
    case MethodKind::kMapping:
      return "mapping";
  }
  return "";
}

constexpr std::optional<MethodKind> ParseMethod(std::string_view name) {
  return FindNamed(kMethods, name);
}

/// Whether the operator needs the robot's camera live: no picture is chosen for them.
constexpr bool NeedsLiveView(MethodKind method) {
  return method == MethodKind::kInstruction || method == MethodKind::kTeleop;
}

}  // namespace conav
