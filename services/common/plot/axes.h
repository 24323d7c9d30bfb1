#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "common/plot/svg.h"

namespace conav {

enum class Scale {
  kLinear,
  kSquareRoot,   // counts: room for the small ones
  kLogarithmic,  // both ends above 0
};

/// An axis of a plot: values from `low` to `high`. A linear one has a tick every `step`, another
/// one at 1, 2 and 5 times the powers of ten; with step 0 there are none.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  double step = 1.0;
  Scale scale = Scale::kLinear;

  /// Linear: low, low + step, ... up to `high`; counts: 0, 1, 2, 5, 10, ...
  std::vector<double> Ticks() const;
  /// The position of `value`: 0 at `low`, 1 at `high`.
  double Share(double value) const;
  /// `value`, or the nearer end if it lies outside.
  double Clamp(double value) const;
  bool Has(double value) const { return value >= low && value <= high; }
};

/// The possible values: a share in [0, 1], a count from 0 on.
struct AxisLimits {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

/// An axis for values in [low, high] with at most `ticks` + 2 ticks (`ticks` at least 1). The ticks
/// are multiples of 1, 2 or 5 times a power of ten, and so are both ends, unless a limit prevents
/// it. If all values are equal, the axis leaves room around them.
Axis RoundAxis(double low, double high, int ticks, const AxisLimits& limits = {});

/// Attributes of the parts of a plot; without others, the classes of the page's style sheet.
struct PlotStyle {
  std::string_view rule = "class=\"rule\"";
  std::string_view tick = "class=\"tick\"";
  std::string_view label = "class=\"label\"";
};

/// For a document without a style sheet.
inline constexpr PlotStyle kDocumentPlotStyle{
    "stroke=\"#dddddd\"", "font-size=\"11\" fill=\"#333333\"", "font-size=\"12\" fill=\"#333333\""};

/// The area of a plot between its axes. y runs upwards; values outside an axis lie at its end.
struct PlotArea {
  PixelPosition corner;  // upper left
  double width = 0.0;
  double height = 0.0;
  Axis x;
  Axis y;
  PlotStyle style = {};
  double label_distance = 42.0;  // pixels from the area to the label of y

  PixelPosition At(double x_value, double y_value) const;
  /// A line and a number at each tick, and the labels that are not empty.
  void Draw(SvgCanvas& canvas, std::string_view x_label, std::string_view y_label) const;
  /// A text below the area, where `value` lies on the x axis.
  void DrawTickX(SvgCanvas& canvas, double value, std::string_view text) const;
};

}  // namespace conav
