#include "planner/experiment/tradeoff_curve.h"

#include <algorithm>
#include <utility>

#include "common/runtime/demand.h"

namespace conav::planner {

TradeoffCurve::TradeoffCurve(std::vector<TradeoffMeans> points) : points_(std::move(points)) {
  DEMAND(!points_.empty());
  std::sort(points_.begin(), points_.end(), [](const TradeoffMeans& a, const TradeoffMeans& b) {
    return std::pair(a.pictures, a.effort) < std::pair(b.pictures, b.effort);
  });
}

std::optional<double> TradeoffCurve::EffortAt(double pictures) const {
  if (pictures < points_.front().pictures) return std::nullopt;
  double least = points_.front().effort;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (pictures < to.pictures) {
      const double share = (pictures - from.pictures) / (to.pictures - from.pictures);
      return std::min(least, from.effort + share * (to.effort - from.effort));
    }
    least = std::min(least, to.effort);
  }
  return least;
}

std::optional<double> TradeoffCurve::PicturesAt(double effort) const {
  if (points_.front().effort <= effort) return points_.front().pictures;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (to.effort > effort) continue;
    const double share = (from.effort - effort) / (from.effort - to.effort);
    return from.pictures + share * (to.pictures - from.pictures);
  }
  return std::nullopt;
}

}  // namespace conav::planner
