#include <array>
#include <catch2/catch.hpp>

#include "common/runtime/random.h"

namespace conav {
namespace {

TEST_CASE("SplitMix64 gives the published numbers", "[runtime]") {
  // Of the seed 1234567, as in the reference implementation's test vector.
  SplitMix64 draws(1234567);
  const std::array<std::uint64_t, 5> expected{6457827717110365317ULL, 3203168211198807973ULL,
                                              9817491932198370423ULL, 4593380528125082431ULL,
                                              16408922859458223821ULL};
  for (const std::uint64_t number : expected) CHECK(draws.Next() == number);
}

TEST_CASE("one draw is two numbers", "[runtime]") {
  SplitMix64 whole(1234567), halved(1234567);
  const SplitMix64::Halves halves = halved.NextHalves();
  CHECK((std::uint64_t{halves.upper} << 32 | halves.lower) == whole.Next());
}

TEST_CASE("32 bits are scaled to each number below the count", "[runtime]") {
  CHECK(ScaledTo(0, 5) == 0);
  CHECK(ScaledTo(0xffffffffU, 5) == 4);
  CHECK(ScaledTo(0x80000000U, 4) == 2);
  CHECK(ScaledTo(0xffffffffU, 1) == 0);
  SplitMix64 draws(1);
  std::array<int, 3> seen{};
  for (int i = 0; i < 3000; ++i) ++seen.at(ScaledTo(draws.NextHalves().upper, 3));
  for (const int count : seen) CHECK(std::abs(count - 1000) < 120);
}

TEST_CASE("bits below a probability's bound: never with 0, always with 1", "[runtime]") {
  CHECK(BitsBelow(0.0) == 0);
  CHECK(BitsBelow(1.0) == std::uint64_t{1} << 32);
  CHECK(BitsBelow(0.5) == std::uint64_t{1} << 31);
}

}  // namespace
}  // namespace conav
