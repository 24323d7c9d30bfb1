#pragma once

#include <optional>
#include <vector>

namespace conav::planner {

/// What an episode takes on average.
struct TradeoffMeans {
  double pictures = 0.0;
  double effort = 0.0;  // steps or moves
};

/// Straight lines between the points of a sweep, from the fewest pictures to the most.
class TradeoffCurve {
 public:
  /// In any order; at least one.
  explicit TradeoffCurve(std::vector<TradeoffMeans> points);

  /// The least effort with at most `pictures`. Nothing below the end with the fewest.
  std::optional<double> EffortAt(double pictures) const;
  /// The fewest pictures with which `effort` is enough. Nothing if the curve never gets there.
  std::optional<double> PicturesAt(double effort) const;

 private:
  std::vector<TradeoffMeans> points_;  // by pictures
};

}  // namespace conav::planner
