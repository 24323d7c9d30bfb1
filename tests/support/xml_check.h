#pragma once

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace conav::test {

/// Whether `text` begins with one of XML's own entities.
inline bool IsEntity(std::string_view text) {
  constexpr std::array<std::string_view, 5> kEntities{"&lt;", "&gt;", "&amp;", "&quot;", "&apos;"};
  return std::any_of(kEntities.begin(), kEntities.end(),
                     [&](std::string_view entity) { return text.starts_with(entity); });
}

/// What is wrong with `text` as XML; empty when it is well-formed. A page of HTML that closes all of
/// its tags passes, too. tinyxml2 lets an unescaped & and control characters pass; this does not.
inline std::string XmlError(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS) {
    return document.ErrorStr();
  }
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto code = static_cast<unsigned char>(text[at]);
    const bool control = code < 0x20 && code != '\t' && code != '\n' && code != '\r';
    if (control || (code == '&' && !IsEntity(std::string_view(text).substr(at)))) {
      return "forbidden: " + text.substr(at, 20);
    }
  }
  return document.RootElement() == nullptr ? "it holds no tag" : "";
}

}  // namespace conav::test
