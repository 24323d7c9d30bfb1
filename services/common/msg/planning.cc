#include "common/msg/planning.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

namespace conav {
namespace {

Result<void> CheckInside(const BeliefGrid& belief, std::span<const Cell> cells, const char* what) {
  for (const Cell cell : cells) {
    if (belief.Contains(cell)) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("perception query: {} cell {} is outside of the {} x {} belief", what,
                            cell, belief.rows(), belief.columns()));
  }
  return {};
}

Result<void> CheckBelief(const BeliefGrid& belief) {
  if (belief.size() == 0) {
    return Fail(ErrorCode::kInvalidArgument, "perception query: the belief has no cells");
  }
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const float probability = belief.values()[i];
    if (probability >= 0.0F && probability <= 1.0F) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("perception query: belief {} at {} is outside of [0, 1]", probability,
                            belief.CellAt(i)));
  }
  return {};
}

}  // namespace

double ExpectedEdits(const PerceptionAnswer& answer) {
  double sum = 0.0;
  for (const float probability : answer.add.values()) sum += static_cast<double>(probability);
  for (const float probability : answer.remove.values()) sum += static_cast<double>(probability);
  return sum;
}

Result<void> CheckPerceptionQuery(const PerceptionQuery& query) {
  if (!std::isfinite(query.heading_rad)) {
    return Fail(ErrorCode::kInvalidArgument, "perception query: the heading is not a number");
  }
  const Cell own[] = {query.cell};
  return CheckBelief(query.belief)
      .and_then([&] { return CheckInside(query.belief, own, "camera"); })
      .and_then([&] { return CheckInside(query.belief, query.path, "path"); })
      .and_then([&] { return CheckInside(query.belief, query.visible.free, "free"); })
      .and_then([&] { return CheckInside(query.belief, query.visible.walls, "wall"); });
}

}  // namespace conav
