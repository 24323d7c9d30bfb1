#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace conav {

/// A foreseeable failure at run time. `text` names the thing, the value and the limit, so that a
/// person can read it as it is.
enum class ErrorCode {
  kInvalidArgument,
  kNotFound,
  kOutOfRange,
  kMalformed,
  kTimeout,
  kRefused,
  kUnavailable,
  kIo,
};

struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string text;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> Fail(ErrorCode code, std::string text) {
  return tl::unexpected<Error>(Error{code, std::move(text)});
}

/// Start-up cannot proceed (bad configuration, missing file, taken port). Only `main` catches it.
class StartupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints the broken contract with its values and aborts. Called by DEMAND only.
[[noreturn]] void DemandFailed(const char* condition, const char* file, int line,
                               const std::string& values);

}  // namespace conav

/// Always-on check of our own contracts: DEMAND(row < rows, row, rows). A failure is a bug of ours,
/// never bad input; bad input gives a Result.
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
