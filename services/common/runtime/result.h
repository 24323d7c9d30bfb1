#pragma once

#include <stdexcept>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace conav {

/// What went wrong, for failures that are foreseen while running. `text` names the thing, the value
/// and the limit, so that it can be shown to a person as it is.
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

}  // namespace conav
