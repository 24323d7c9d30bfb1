#pragma once

#include <catch2/catch.hpp>
#include <optional>

#include "common/runtime/result.h"

namespace conav::test {

/// `result` is an error, of that kind where one is given, and the matcher `says` fits its reason.
template <class T, class Matcher>
void CheckRefusal(const Result<T>& result, const Matcher& says,
                  std::optional<ErrorCode> code = std::nullopt) {
  INFO("the reason " << says.toString());
  REQUIRE_FALSE(result);
  if (code) CHECK(result.error().code == *code);
  CHECK_THAT(result.error().text, says);
}

}  // namespace conav::test
