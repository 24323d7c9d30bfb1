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

/// Collects the elements of an SVG document, which is well-formed XML whatever is drawn.
///
/// `style` is a list of attributes with blanks between, `fill="#000" stroke="#888"`; anything else is
/// a broken contract. An attribute that is there already, from the element or from the list, is
/// replaced.
class SvgCanvas {
 public:
  void Rectangle(PixelPosition corner, double width, double height, std::string_view style);
  void Line(PixelPosition from, PixelPosition to, std::string_view style);
  /// Not filled, unless `style` says so.
  void Polyline(const std::vector<PixelPosition>& positions, std::string_view style);
  void Polygon(const std::vector<PixelPosition>& positions, std::string_view style);
  void Circle(PixelPosition middle, double radius, std::string_view style);
  /// Two diagonals of a square of 2 `reach`.
  void Cross(PixelPosition middle, double reach, std::string_view style);
  void Text(PixelPosition position, std::string_view text, std::string_view style);
  /// Everything up to EndGroup belongs together; `title` is shown where the mouse rests.
  void BeginGroup(std::string_view title);
  void EndGroup();

  /// The document; `title` is what a screen reader says.
  std::string Document(double width, double height, std::string_view title) const;

  /// The same as an element of an HTML page, with no background: the page's style sheet gives the
  /// colours of its classes.
  std::string Inline(double width, double height, std::string_view title) const;

 private:
  std::string body_;
};

/// `text` with <, >, & and quotes as entities, and blanks for control characters.
std::string EscapeXml(std::string_view text);

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
