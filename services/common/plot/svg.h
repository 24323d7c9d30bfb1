#pragma once

#include <cstdint>
#include <span>
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
  /// A JPEG picture, in the document itself.
  void Jpeg(PixelPosition corner, double width, double height, std::span<const std::uint8_t> bytes);
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

}  // namespace conav
