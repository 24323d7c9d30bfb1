#pragma once

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

}  // namespace conav
