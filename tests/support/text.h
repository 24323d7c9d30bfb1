#pragma once

#include <string>
#include <string_view>

namespace conav::test {

/// How often `part` stands in `text`.
inline int CountOf(const std::string& text, std::string_view part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace conav::test
