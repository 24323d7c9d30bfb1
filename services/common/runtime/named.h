#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conav {

/// The one of `values`, enumerators with a Name(), that is called `name`.
template <class Values>
constexpr auto FindNamed(const Values& values, std::string_view name)
    -> std::optional<typename Values::value_type> {
  for (const auto& value : values) {
    if (Name(value) == name) return value;
  }
  return std::nullopt;
}

/// Their names, for configurations and messages.
template <class Values>
std::vector<std::string> Names(const Values& values) {
  std::vector<std::string> names;
  for (const auto& value : values) names.emplace_back(Name(value));
  return names;
}

}  // namespace conav
