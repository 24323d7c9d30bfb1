#include "operator/statistics/report_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/svg/svg_canvas.h"

namespace conav::statistics {
namespace {

constexpr double kLeft = 64.0;
constexpr double kRight = 16.0;
constexpr double kTop = 12.0;
constexpr double kHeight = 320.0;  // of the axis
constexpr double kBelow = 32.0;
constexpr double kConditionWidth = 120.0;
constexpr std::size_t kMostLetters = 16;

/// y upwards from `low` to `high`, with a tick every `step`.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  double step = 1.0;
  double At(double value) const { return kTop + kHeight * (high - value) / (high - low); }
};

/// 1, 2 or 5 times a power of ten, at least `least`.
double RoundStep(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

Axis AxisFor(const Analysis& analysis) {
  const auto [least, most] =
      std::minmax_element(analysis.table.values.begin(), analysis.table.values.end());
  double low = *least;
  double high = *most;
  for (const Description& row : analysis.conditions) {
    low = std::min({low, row.mean_interval.low, row.within_interval.low});
    high = std::max({high, row.mean_interval.high, row.within_interval.high});
  }
  if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {
    const double room = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    low -= room;
    high += room;
  }
  const double step = RoundStep((high - low) / 6.0);
  return {step * std::floor(low / step), step * std::ceil(high / step), step};
}

double MiddleOf(std::size_t condition) {
  return kLeft + kConditionWidth * (static_cast<double>(condition) + 0.5);
}

/// At most kMostLetters characters of UTF-8.
std::string Shortened(const std::string& name) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if ((static_cast<unsigned>(name[i]) & 0xC0U) == 0x80U) continue;
    if (++letters > kMostLetters) return name.substr(0, i) + "...";
  }
  return name;
}

void DrawAxes(SvgCanvas& canvas, const Axis& axis, const Analysis& analysis) {
  const std::size_t k = analysis.table.condition_count();
  const double right = kLeft + kConditionWidth * static_cast<double>(k);
  const auto ticks = static_cast<int>(std::lround((axis.high - axis.low) / axis.step));
  for (int i = 0; i <= ticks; ++i) {
    double value = axis.low + axis.step * i;
    if (std::abs(value) < 1e-9 * axis.step) value = 0.0;
    canvas.Line({kLeft, axis.At(value)}, {right, axis.At(value)}, "class=\"rule\"");
    canvas.Text({kLeft - 6, axis.At(value) + 4}, fmt::format("{:.6g}", value),
                "class=\"tick\" text-anchor=\"end\"");
  }
  for (std::size_t j = 0; j < k; ++j) {
    canvas.BeginGroup(analysis.table.conditions[j]);
    canvas.Text({MiddleOf(j), kTop + kHeight + 20}, Shortened(analysis.table.conditions[j]),
                "class=\"label\" text-anchor=\"middle\"");
    canvas.EndGroup();
  }
}

void DrawSubjects(SvgCanvas& canvas, const Axis& axis, const ConditionTable& table) {
  for (std::size_t i = 0; i < std::min(table.subject_count(), kMostLines); ++i) {
    std::vector<PixelPosition> line;
    for (std::size_t j = 0; j < table.condition_count(); ++j) {
      line.push_back({MiddleOf(j), axis.At(table.At(i, j))});
    }
    canvas.BeginGroup(table.subjects[i]);
    canvas.Polyline(line, "class=\"subject\"");
    canvas.EndGroup();
  }
}

void DrawMean(SvgCanvas& canvas, const Axis& axis, double x, const Description& row) {
  canvas.BeginGroup(
      fmt::format("{}: mean {:.5g} [{:.5g}, {:.5g}], within subjects [{:.5g}, {:.5g}]",
                  row.condition, row.mean, row.mean_interval.low, row.mean_interval.high,
                  row.within_interval.low, row.within_interval.high));
  for (const double end : {row.mean_interval.low, row.mean_interval.high}) {
    canvas.Line({x - 7, axis.At(end)}, {x + 7, axis.At(end)}, "class=\"interval\"");
  }
  canvas.Line({x, axis.At(row.mean_interval.low)}, {x, axis.At(row.mean_interval.high)},
              "class=\"interval\"");
  canvas.Line({x, axis.At(row.within_interval.low)}, {x, axis.At(row.within_interval.high)},
              "class=\"within\"");
  canvas.Circle({x, axis.At(row.mean)}, 5, "class=\"mean\"");
  canvas.EndGroup();
}

}  // namespace

std::string ConditionsPlot(const Analysis& analysis) {
  SvgCanvas canvas;
  const Axis axis = AxisFor(analysis);
  DrawAxes(canvas, axis, analysis);
  DrawSubjects(canvas, axis, analysis.table);
  std::string title = "Means of the conditions:";
  for (std::size_t j = 0; j < analysis.conditions.size(); ++j) {
    DrawMean(canvas, axis, MiddleOf(j), analysis.conditions[j]);
    title +=
        fmt::format(" {} {:.5g}", analysis.conditions[j].condition, analysis.conditions[j].mean);
  }
  const auto k = static_cast<double>(analysis.conditions.size());
  return canvas.Inline(kLeft + kConditionWidth * k + kRight, kTop + kHeight + kBelow, title);
}

}  // namespace conav::statistics
