#include "common/msg/planning.h"

#include <fmt/core.h>

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

Result<void> CheckHeading(double heading_rad) {
  if (std::isfinite(heading_rad)) return {};
  return Fail(ErrorCode::kInvalidArgument, "perception query: the heading is not a number");
}

/// `shown` is a PerceptionQuery or a ShownView.
template <class Shown>
Result<void> CheckCells(const BeliefGrid& belief, const Shown& shown) {
  return CheckInside(belief, std::span(&shown.cell, 1), "camera")
      .and_then([&] { return CheckInside(belief, shown.path, "path"); })
      .and_then([&] { return CheckInside(belief, shown.visible.free, "free"); })
      .and_then([&] { return CheckInside(belief, shown.visible.walls, "wall"); });
}

}  // namespace

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

double ExpectedEdits(const PerceptionAnswer& answer) {
  std::int64_t units = 0;
  for (const float probability : answer.add.values()) units += EditUnits(probability);
  for (const float probability : answer.remove.values()) units += EditUnits(probability);
  return EditsOf(units);
}

Result<void> CheckPerceptionQuery(const PerceptionQuery& query) {
  return CheckHeading(query.heading_rad)
      .and_then([&] { return CheckBelief(query.belief); })
      .and_then([&] { return CheckCells(query.belief, query); });
}

Result<void> CheckShownView(const BeliefGrid& belief, const ShownView& view) {
  return CheckHeading(view.heading_rad).and_then([&] { return CheckCells(belief, view); });
}

}  // namespace conav
