#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace conav {

/// Pixels, x to the right, y down.
struct PixelPosition {
  double x = 0.0;
  double y = 0.0;
};

/// Collects the elements of an SVG document. The result is always well-formed XML.
///
/// `style` is a list of attributes separated by blanks, `fill="#000" stroke="#888"`; anything else
/// is a broken contract. A repeated attribute, from the element or the list, replaces the earlier
/// one.
class SvgCanvas {
 public:
  void Rectangle(PixelPosition corner, double width, double height, std::string_view style);
  void Line(PixelPosition from, PixelPosition to, std::string_view style);
  /// Not filled unless `style` says so.
  void Polyline(const std::vector<PixelPosition>& positions, std::string_view style);
  void Polygon(const std::vector<PixelPosition>& positions, std::string_view style);
  void Circle(PixelPosition middle, double radius, std::string_view style);
  /// The two diagonals of a square with sides 2 `reach`.
  void Cross(PixelPosition middle, double reach, std::string_view style);
  void Text(PixelPosition position, std::string_view text, std::string_view style);
  /// Groups everything up to EndGroup; `title` is the tooltip.
  void BeginGroup(std::string_view title);
  void EndGroup();

  /// The whole document; a screen reader reads `title`.
  std::string Document(double width, double height, std::string_view title) const;

  /// The same as an element of an HTML page, without background; the page's style sheet colours its
  /// classes.
  std::string Inline(double width, double height, std::string_view title) const;

 private:
  std::string body_;
};

/// `text` with <, >, & and quotes as entities, and blanks for control characters.
std::string EscapeXml(std::string_view text);

/// An axis of a plot: values from `low` to `high`, a tick every `step`.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  double step = 1.0;

  /// low, low + step, ... up to `high`.
  std::vector<double> Ticks() const;
  /// The position of `value`: 0 at `low`, 1 at `high`.
  double Share(double value) const { return (value - low) / (high - low); }
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

}  // namespace conav
