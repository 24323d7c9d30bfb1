#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "common/msg/convert.h"

namespace conav {

/// The round trip of each value gives the value.
template <class... Domains>
void CheckRoundTrips(const Domains&... values) {
  const auto check = [](const auto& value) {
    CAPTURE(typeid(value).name());
    const auto back = ToDomain(ToMessage(value));
    REQUIRE(back);
    CHECK(*back == value);
  };
  (check(values), ...);
}

template <class Domain>
using MessageOf = decltype(ToMessage(std::declval<const Domain&>()));

/// What makes a valid message malformed, and what its refusal begins with: the field.
template <class Message>
struct Rejection {
  std::string begins_with;
  void (*spoil)(Message&);
};

/// Each row spoils the message of the valid `value`; `sizes` are those that ToDomain asks for.
template <class Domain, class... Sizes>
void CheckRefused(const Domain& value, const std::vector<Rejection<MessageOf<Domain>>>& rows,
                  Sizes... sizes) {
  for (const auto& row : rows) {
    CAPTURE(row.begins_with);
    auto message = ToMessage(value);
    row.spoil(message);
    const auto result = ToDomain(message, sizes...);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kMalformed);
    CHECK_THAT(result.error().text, Catch::StartsWith(row.begins_with));
  }
}

}  // namespace conav
