#include "common/svg/axis.h"

#include <algorithm>
#include <cmath>

namespace conav {
namespace {

/// 1, 2 or 5 times a power of ten, at least `least`.
double RoundStep(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace

std::vector<double> Axis::Ticks() const {
  std::vector<double> ticks;
  const auto last = static_cast<int>(std::floor((high - low) / step + 1e-6));
  for (int i = 0; i <= last; ++i) {
    const double value = low + step * i;
    ticks.push_back(std::abs(value) < 1e-9 * step ? 0.0 : value);
  }
  return ticks;
}

double Axis::Clamp(double value) const { return std::clamp(value, low, high); }

Axis RoundAxis(double low, double high, int ticks, const AxisLimits& limits) {
  low = std::max(low, limits.least);
  high = std::min(high, limits.most);
  if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {
    const double room = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    low = std::max(low - room, limits.least);
    high = std::min(high + room, limits.most);
  }
  const double step = RoundStep((high - low) / ticks);
  return {std::max(step * std::floor(low / step), limits.least),
          std::min(step * std::ceil(high / step), limits.most), step};
}

}  // namespace conav
