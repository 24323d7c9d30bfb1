#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "common/msg/convert.h"

namespace conav {

/// The round trip of a value gives the value.
template <class Domain>
void CheckRoundTrip(const Domain& value) {
  const auto back = ToDomain(ToMessage(value));
  REQUIRE(back);
  CHECK(*back == value);
}

/// Spoils the message of a valid value and expects exactly this refusal.
template <class Domain, class Spoil>
void CheckRefused(const Domain& value, Spoil spoil, const std::string& text) {
  auto message = ToMessage(value);
  spoil(message);
  const auto result = ToDomain(message);
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::kMalformed);
  CHECK(result.error().text == text);
}

}  // namespace conav
