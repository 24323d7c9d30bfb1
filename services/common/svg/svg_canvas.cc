#include "common/svg/svg_canvas.h"

#include <fmt/format.h>

namespace conav {
namespace {

std::string List(const std::vector<PixelPosition>& positions) {
  std::string text;
  for (const PixelPosition& position : positions) {
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", position.x, position.y);
  }
  return text;
}

}  // namespace

std::string EscapeXml(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

void SvgCanvas::Rectangle(PixelPosition corner, double width, double height,
                          std::string_view style) {
  body_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>\n",
                       corner.x, corner.y, width, height, style);
}

void SvgCanvas::Line(PixelPosition from, PixelPosition to, std::string_view style) {
  body_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n",
                       from.x, from.y, to.x, to.y, style);
}

void SvgCanvas::Polyline(const std::vector<PixelPosition>& positions, std::string_view style) {
  body_ += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", List(positions), style);
}

void SvgCanvas::Polygon(const std::vector<PixelPosition>& positions, std::string_view style) {
  body_ += fmt::format("<polygon points=\"{}\" {}/>\n", List(positions), style);
}

void SvgCanvas::Circle(PixelPosition middle, double radius, std::string_view style) {
  body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>\n", middle.x,
                       middle.y, radius, style);
}

void SvgCanvas::Cross(PixelPosition middle, double reach, std::string_view style) {
  Line({middle.x - reach, middle.y - reach}, {middle.x + reach, middle.y + reach}, style);
  Line({middle.x - reach, middle.y + reach}, {middle.x + reach, middle.y - reach}, style);
}

void SvgCanvas::Text(PixelPosition position, std::string_view text, std::string_view style) {
  body_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", position.x, position.y,
                       style, EscapeXml(text));
}

void SvgCanvas::BeginGroup(std::string_view title) {
  body_ += fmt::format("<g><title>{}</title>\n", EscapeXml(title));
}

void SvgCanvas::EndGroup() { body_ += "</g>\n"; }

std::string SvgCanvas::Inline(double width, double height, std::string_view title) const {
  return fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" "
      "aria-label=\"{2}\">\n<title>{2}</title>\n{3}</svg>\n",
      width, height, EscapeXml(title), body_);
}

std::string SvgCanvas::Document(double width, double height, std::string_view title) const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" role=\"img\" font-family=\"sans-serif\">\n<title>{2}</title>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{3}</svg>\n",
      width, height, EscapeXml(title), body_);
}

}  // namespace conav
