#include "common/plot/svg.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "common/runtime/result.h"

namespace conav {
namespace {

std::string List(const std::vector<PixelPosition>& positions) {
  std::string text;
  for (const PixelPosition& position : positions) {
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", position.x, position.y);
  }
  return text;
}

using Attributes = std::vector<std::pair<std::string_view, std::string>>;

void Set(Attributes& attributes, std::string_view name, std::string_view value) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const auto& attribute) { return attribute.first == name; });
  if (found == attributes.end())
    attributes.emplace_back(name, value);
  else
    found->second = value;
}

/// Adds the attributes of a list, as the header describes it.
void SetAll(Attributes& attributes, std::string_view list) {
  const std::string_view whole = list;
  while (!list.empty()) {
    const std::size_t equals = list.find("=\"");
    DEMAND(equals != 0 && equals != std::string_view::npos, whole);
    const std::size_t end = list.find('"', equals + 2);
    DEMAND(end != std::string_view::npos, whole);
    Set(attributes, list.substr(0, equals), list.substr(equals + 2, end - equals - 2));
    list.remove_prefix(std::min(list.find_first_not_of(' ', end + 1), list.size()));
  }
}

/// "<name a="1" b="2"": the caller closes the tag.
std::string OpenTag(std::string_view name, Attributes attributes, std::string_view style) {
  SetAll(attributes, style);
  std::string text = fmt::format("<{}", name);
  for (const auto& [key, value] : attributes) text += fmt::format(" {}=\"{}\"", key, value);
  return text;
}

/// RFC 4648, with padding.
std::string Base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8U | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

std::string Pixels(double value) { return fmt::format("{:.1f}", value); }

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
        // XML 1.0 cannot express control characters, not even as entities.
        escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return escaped;
}

void SvgCanvas::Rectangle(PixelPosition corner, double width, double height,
                          std::string_view style) {
  body_ += OpenTag("rect",
                   {{"x", Pixels(corner.x)},
                    {"y", Pixels(corner.y)},
                    {"width", Pixels(width)},
                    {"height", Pixels(height)}},
                   style) +
           "/>\n";
}

void SvgCanvas::Line(PixelPosition from, PixelPosition to, std::string_view style) {
  body_ += OpenTag("line",
                   {{"x1", Pixels(from.x)},
                    {"y1", Pixels(from.y)},
                    {"x2", Pixels(to.x)},
                    {"y2", Pixels(to.y)}},
                   style) +
           "/>\n";
}

void SvgCanvas::Polyline(const std::vector<PixelPosition>& positions, std::string_view style) {
  body_ += OpenTag("polyline", {{"points", List(positions)}, {"fill", "none"}}, style) + "/>\n";
}

void SvgCanvas::Polygon(const std::vector<PixelPosition>& positions, std::string_view style) {
  body_ += OpenTag("polygon", {{"points", List(positions)}}, style) + "/>\n";
}

void SvgCanvas::Circle(PixelPosition middle, double radius, std::string_view style) {
  body_ +=
      OpenTag("circle", {{"cx", Pixels(middle.x)}, {"cy", Pixels(middle.y)}, {"r", Pixels(radius)}},
              style) +
      "/>\n";
}

void SvgCanvas::Cross(PixelPosition middle, double reach, std::string_view style) {
  Line({middle.x - reach, middle.y - reach}, {middle.x + reach, middle.y + reach}, style);
  Line({middle.x - reach, middle.y + reach}, {middle.x + reach, middle.y - reach}, style);
}

void SvgCanvas::Text(PixelPosition position, std::string_view text, std::string_view style) {
  body_ +=
      fmt::format("{}>{}</text>\n",
                  OpenTag("text", {{"x", Pixels(position.x)}, {"y", Pixels(position.y)}}, style),
                  EscapeXml(text));
}

void SvgCanvas::Jpeg(PixelPosition corner, double width, double height,
                     std::span<const std::uint8_t> bytes) {
  body_ += OpenTag("image",
                   {{"x", Pixels(corner.x)},
                    {"y", Pixels(corner.y)},
                    {"width", Pixels(width)},
                    {"height", Pixels(height)},
                    {"href", "data:image/jpeg;base64," + Base64(bytes)}},
                   "") +
           "/>\n";
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
