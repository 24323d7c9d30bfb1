#include "planner/experiment/tradeoff_curve.h"

#include <algorithm>
#include <utility>

#include "common/runtime/demand.h"

namespace conav::planner {

TradeoffCurve::TradeoffCurve(std::vector<TradeoffMeans> points) : points_(std::move(points)) {
  DEMAND(!points_.empty());
  std::sort(points_.begin(), points_.end(), [](const TradeoffMeans& a, const TradeoffMeans& b) {
    return std::pair(a.pictures, a.moves) < std::pair(b.pictures, b.moves);
  });
}

std::optional<double> TradeoffCurve::MovesAt(double pictures) const {
  if (pictures < points_.front().pictures) return std::nullopt;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (pictures >= to.pictures) continue;
    const double share = (pictures - from.pictures) / (to.pictures - from.pictures);
    return from.moves + share * (to.moves - from.moves);
  }
  return points_.back().moves;
}

std::optional<double> TradeoffCurve::PicturesAt(double moves) const {
  if (points_.front().moves <= moves) return points_.front().pictures;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (to.moves > moves) continue;
    const double share = (from.moves - moves) / (from.moves - to.moves);
    return from.pictures + share * (to.pictures - from.pictures);
  }
  return std::nullopt;
}

}  // namespace conav::planner
