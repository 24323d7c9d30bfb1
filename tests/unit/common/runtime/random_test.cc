#include "common/runtime/random.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

namespace conav {
namespace {

TEST_CASE("a range of one value and that of all values take one draw", "[random]") {
  Random bounded(7);
  Random reference(7);
  CHECK(bounded.Uniform(5, 5) == 5);
  reference.Next();
  CHECK(bounded.Uniform(INT64_MIN, INT64_MAX) == static_cast<std::int64_t>(reference.Next()));
}

TEST_CASE("the unit interval holds its lower end only, chances take one draw each", "[random]") {
  Random random(2);
  double sum = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double value = random.Unit();
    REQUIRE(value >= 0.0);
    REQUIRE(value < 1.0);
    sum += value;
  }
  CHECK(sum / 10000 == Approx(0.5).margin(0.02));
  Random chances(4);
  Random reference(4);
  for (int i = 0; i < 100; ++i) {
    CHECK_FALSE(chances.Chance(0.0));
    CHECK(chances.Chance(1.0));
    reference.Next();
    reference.Next();
  }
  CHECK(chances.Next() == reference.Next());
}

#if defined(__GLIBCXX__) && __GLIBCXX__ >= 20210000
TEST_CASE("integers and shuffles equal libstdc++'s", "[random]") {
  for (std::size_t size = 0; size < 40; ++size) {
    std::vector<std::size_t> ours(size);
    std::iota(ours.begin(), ours.end(), 0U);
    std::vector<std::size_t> theirs = ours;
    Random random(size);
    std::mt19937_64 engine(size);
    random.Shuffle(ours);
    std::shuffle(theirs.begin(), theirs.end(), engine);
    CHECK(ours == theirs);
    std::uniform_int_distribution<std::int64_t> distribution(-7, static_cast<std::int64_t>(size));
    for (int i = 0; i < 20; ++i) {
      CHECK(random.Uniform(-7, static_cast<std::int64_t>(size)) == distribution(engine));
    }
  }
}
#endif

TEST_CASE("derived seeds differ by seed and by purpose, and stay what they were", "[random]") {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (std::uint64_t purpose = 0; purpose < 30; ++purpose) {
      seeds.insert(DeriveSeed(seed, purpose));
    }
  }
  CHECK(seeds.size() == 900);
  CHECK(DeriveSeed(1234567, 0) == 6457827717110365317ULL);
  CHECK(DeriveSeed(1234567, 1) == 3203168211198807973ULL);
}

TEST_CASE("SplitMix64 gives the published numbers, whole or as two halves", "[runtime]") {
  // Of the seed 1234567, as in the reference implementation's test vector.
  SplitMix64 draws(1234567), halved(1234567);
  for (const std::uint64_t number :
       {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
        4593380528125082431ULL, 16408922859458223821ULL}) {
    CHECK(draws.Next() == number);
    const SplitMix64::Halves halves = halved.NextHalves();
    CHECK((std::uint64_t{halves.upper} << 32 | halves.lower) == number);
  }
}

TEST_CASE("32 bits are scaled to each number below the count", "[runtime]") {
  CHECK(ScaledTo(0, 5) == 0);
  CHECK(ScaledTo(0xffffffffU, 5) == 4);
  CHECK(ScaledTo(0x80000000U, 4) == 2);
  CHECK(ScaledTo(0xffffffffU, 1) == 0);
  CHECK(ScaledTo(0x55555555U, 3) == 0);
  CHECK(ScaledTo(0x55555556U, 3) == 1);
}

TEST_CASE("bits below a probability's bound: never with 0, always with 1", "[runtime]") {
  CHECK(BitsBelow(0.0) == 0);
  CHECK(BitsBelow(1.0) == std::uint64_t{1} << 32);
  CHECK(BitsBelow(0.5) == std::uint64_t{1} << 31);
}

}  // namespace
}  // namespace conav
