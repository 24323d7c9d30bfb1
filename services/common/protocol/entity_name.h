#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace conav {

/// Names of worlds and robots become parts of topics: 1 to kMaxName of A-Z a-z 0-9 _.
inline constexpr std::size_t kMaxName = 64;

inline bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

inline bool IsEntityName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxName &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

}  // namespace conav
