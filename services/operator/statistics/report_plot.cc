#include "operator/statistics/report_plot.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/svg/axis.h"
#include "common/svg/svg_canvas.h"

namespace conav::statistics {
namespace {

constexpr double kLeft = 72.0;
constexpr double kRight = 16.0;
constexpr double kTop = 12.0;
constexpr double kHeight = 320.0;  // of the axis
constexpr double kBelow = 32.0;
constexpr double kConditionWidth = 120.0;
constexpr std::size_t kMostLetters = 16;

constexpr int kTicks = 6;

/// y upwards.
double At(const Axis& axis, double value) {
  return kTop + kHeight * (1.0 - axis.Share(axis.Clamp(value)));
}

Axis AxisFor(const Analysis& analysis, const AxisLimits& limits) {
  const auto [least, most] =
      std::minmax_element(analysis.table.values.begin(), analysis.table.values.end());
  double low = *least;
  double high = *most;
  for (const Description& row : analysis.conditions) {
    low = std::min({low, row.mean_interval.low, row.within_interval.low});
    high = std::max({high, row.mean_interval.high, row.within_interval.high});
  }
  return RoundAxis(low, high, kTicks, limits);
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
  for (const double value : axis.Ticks()) {
    const double y = At(axis, value);
    canvas.Line({kLeft, y}, {right, y}, "class=\"rule\"");
    canvas.Text({kLeft - 6, y + 4}, fmt::format("{:.6g}", value),
                "class=\"tick\" text-anchor=\"end\"");
  }
  for (std::size_t j = 0; j < k; ++j) {
    canvas.BeginGroup(analysis.table.conditions[j]);
    canvas.Text({MiddleOf(j), kTop + kHeight + 20}, Shortened(analysis.table.conditions[j]),
                "class=\"label\" text-anchor=\"middle\"");
    canvas.EndGroup();
  }
}

/// Along the axis, upwards.
void DrawLabel(SvgCanvas& canvas, const std::string& label) {
  constexpr double kMiddle = kTop + kHeight / 2;
  canvas.Text({14.0, kMiddle}, label,
              fmt::format(R"x(class="label" text-anchor="middle" transform="rotate(-90 14 {})")x",
                          kMiddle));
}

void DrawSubjects(SvgCanvas& canvas, const Axis& axis, const ConditionTable& table) {
  for (std::size_t i = 0; i < std::min(table.subject_count(), kMostLines); ++i) {
    std::vector<PixelPosition> line;
    for (std::size_t j = 0; j < table.condition_count(); ++j) {
      line.push_back({MiddleOf(j), At(axis, table.At(i, j))});
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
    if (!axis.Has(end)) continue;  // the interval runs on where no value can be
    canvas.Line({x - 7, At(axis, end)}, {x + 7, At(axis, end)}, "class=\"interval\"");
  }
  const auto draw = [&](const Interval& interval, const char* style) {
    canvas.Line({x, At(axis, interval.low)}, {x, At(axis, interval.high)}, style);
  };
  draw(row.mean_interval, "class=\"interval\"");
  draw(row.within_interval, "class=\"within\"");
  canvas.Circle({x, At(axis, row.mean)}, 5, "class=\"mean\"");
  canvas.EndGroup();
}

}  // namespace

std::string ConditionsPlot(const Analysis& analysis, const PlotAxis& values) {
  SvgCanvas canvas;
  const Axis axis = AxisFor(analysis, values.limits);
  DrawAxes(canvas, axis, analysis);
  if (!values.label.empty()) DrawLabel(canvas, values.label);
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
