#pragma once

#include <fmt/format.h>

#include <string>

namespace conav {

/// Prints the broken contract with its values and aborts. Called by DEMAND only.
[[noreturn]] void DemandFailed(const char* condition, const char* file, int line,
                               const std::string& values);

}  // namespace conav

/// Always-on check of our own contracts: DEMAND(row < rows, row, rows). A failure is a bug of ours,
/// never of the input; input is refused with a Result instead.
#define DEMAND(condition, ...)                                                         \
  do {                                                                                 \
    if (!(condition)) [[unlikely]] {                                                   \
      ::conav::DemandFailed(                                                           \
          #condition, __FILE__, __LINE__,                                              \
          ::conav::internal::DescribeValues(#__VA_ARGS__ __VA_OPT__(, ) __VA_ARGS__)); \
    }                                                                                  \
  } while (false)

namespace conav::internal {

template <class... Values>
std::string DescribeValues(const char* names, const Values&... values) {
  std::string text = names;
  if constexpr (sizeof...(values) > 0) {
    text += " =";
    ((text += fmt::format(" {}", values)), ...);
  }
  return text;
}

}  // namespace conav::internal
