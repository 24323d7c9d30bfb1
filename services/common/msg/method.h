#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Nothing when there is no method of that name.
constexpr std::optional<MethodKind> ParseMethod(std::string_view name) {
  for (const MethodKind method : kMethods) {
    if (Name(method) == name) return method;
  }
  return std::nullopt;
}

/// For configurations and help texts.
inline std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const MethodKind method : kMethods) names.emplace_back(Name(method));
  return names;
}

}  // namespace conav
