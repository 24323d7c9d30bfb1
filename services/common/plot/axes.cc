#include "common/plot/axes.h"

#include <fmt/core.h>

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

double Scaled(Scale scale, double value) {
  if (scale == Scale::kLinear) return value;
  return scale == Scale::kSquareRoot ? std::sqrt(value) : std::log(value);
}

std::string Anchored(std::string_view style, const char* anchor) {
  return fmt::format("{} text-anchor=\"{}\"", style, anchor);
}

}  // namespace

std::vector<double> Axis::Ticks() const {
  std::vector<double> ticks;
  if (step == 0.0) return ticks;
  if (scale == Scale::kLinear) {
    const auto last = static_cast<int>(std::floor((high - low) / step + 1e-6));
    for (int i = 0; i <= last; ++i) {
      const double value = low + step * i;
      ticks.push_back(std::abs(value) < 1e-9 * step ? 0.0 : value);
    }
    return ticks;
  }
  if (scale == Scale::kSquareRoot && low == 0.0) ticks.push_back(0.0);
  const double first = scale == Scale::kSquareRoot ? 1.0 : low;
  for (double power = std::pow(10.0, std::floor(std::log10(first))); power <= high; power *= 10.0) {
    for (const double tick : {power, 2.0 * power, 5.0 * power}) {
      if (Has(tick)) ticks.push_back(tick);
    }
  }
  return ticks;
}

double Axis::Share(double value) const {
  const double start = Scaled(scale, low);
  return (Scaled(scale, value) - start) / (Scaled(scale, high) - start);
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

PixelPosition PlotArea::At(double x_value, double y_value) const {
  return {corner.x + width * x.Share(x.Clamp(x_value)),
          corner.y + height * (1.0 - y.Share(y.Clamp(y_value)))};
}

void PlotArea::Draw(SvgCanvas& canvas, std::string_view x_label, std::string_view y_label) const {
  for (const double value : x.Ticks()) {
    canvas.Line(At(value, y.low), At(value, y.high), style.rule);
    DrawTickX(canvas, value, fmt::format("{:g}", value));
  }
  for (const double value : y.Ticks()) {
    const PixelPosition left = At(x.low, value);
    canvas.Line(left, At(x.high, value), style.rule);
    canvas.Text({left.x - 6.0, left.y + 4.0}, fmt::format("{:g}", value),
                Anchored(style.tick, "end"));
  }
  const PixelPosition below{corner.x + width / 2.0, corner.y + height + 36.0};
  const PixelPosition left{corner.x - label_distance, corner.y + height / 2.0};
  const std::string label = Anchored(style.label, "middle");
  if (!x_label.empty()) canvas.Text(below, x_label, label);
  if (y_label.empty()) return;
  canvas.Text(left, y_label,
              fmt::format("{} transform=\"rotate(-90 {} {})\"", label, left.x, left.y));
}

void PlotArea::DrawTickX(SvgCanvas& canvas, double value, std::string_view text) const {
  const PixelPosition below = At(value, y.low);
  canvas.Text({below.x, below.y + 17.0}, text, Anchored(style.tick, "middle"));
}

}  // namespace conav
