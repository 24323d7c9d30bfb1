#pragma once

#include <tinyxml2.h>

#include <regex>
#include <string>

namespace conav::test {

/// What is wrong with `text` as XML; empty when it is well-formed. A page of HTML that closes all of
/// its tags passes, too. tinyxml2 lets an unescaped & and control characters pass; this does not.
inline std::string XmlError(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS) {
    return document.ErrorStr();
  }
  static const std::regex forbidden(
      "&(?!(lt|gt|amp|quot|apos);)|[\\x01-\\x08\\x0b\\x0c\\x0e-\\x1f]");
  std::smatch found;
  if (std::regex_search(text, found, forbidden)) return "forbidden: " + found.suffix().str();
  return document.RootElement() == nullptr ? "it holds no tag" : "";
}

}  // namespace conav::test
