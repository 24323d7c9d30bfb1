#pragma once

#include <limits>
#include <vector>

namespace conav {

/// The values of an axis of a plot: from `low` to `high`, a tick every `step`.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  double step = 1.0;

  /// low, low + step, ... up to `high`.
  std::vector<double> Ticks() const;
  /// Where `value` lies: 0 at `low`, 1 at `high`.
  double Share(double value) const { return (value - low) / (high - low); }
  /// `value`, or the end that it is beyond.
  double Clamp(double value) const;
  bool Has(double value) const { return value >= low && value <= high; }
};

/// What values can be at all: a share in [0, 1], a count from 0 on.
struct AxisLimits {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

/// An axis for values in [low, high] with at most `ticks` + 2 ticks (`ticks` at least 1): they are
/// multiples of 1, 2 or 5 times a power of ten, and so are both ends, unless a limit is in the way.
/// Values that are all the same have room around them.
Axis RoundAxis(double low, double high, int ticks, const AxisLimits& limits = {});

}  // namespace conav
