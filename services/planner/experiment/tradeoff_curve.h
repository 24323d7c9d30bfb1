#pragma once

#include <optional>
#include <vector>

namespace conav::planner {

/// What an episode takes on average.
struct TradeoffMeans {
  double pictures = 0.0;
  double moves = 0.0;
};

/// Straight lines between the points of a sweep, from the fewest pictures to the most.
class TradeoffCurve {
 public:
  /// In any order; at least one.
  explicit TradeoffCurve(std::vector<TradeoffMeans> points);

  /// Moves at `pictures`; beyond the end with the most pictures those of that end. Nothing below
  /// the end with the fewest.
  std::optional<double> MovesAt(double pictures) const;
  /// The fewest pictures with which at most `moves` are made. Nothing if the curve never gets there.
  std::optional<double> PicturesAt(double moves) const;

 private:
  std::vector<TradeoffMeans> points_;  // by pictures
};

}  // namespace conav::planner
