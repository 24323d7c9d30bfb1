#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

/// Seeded random numbers that are the same on every platform and standard library.
///
/// The C++ standard fixes std::mt19937_64 but not its distributions, so this class implements them.
/// Bounded integers use Lemire's multiply-and-reject method (D. Lemire, "Fast Random Integer
/// Generation in an Interval", ACM TOMACS 29(1), 2019), as libstdc++ >= 11 does. Threads: not
/// synchronised; one per thread.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// One raw draw.
  std::uint64_t Next() { return engine_(); }

  /// Uniform integer in [low, high], both ends included. Requires low <= high.
  std::int64_t Uniform(std::int64_t low, std::int64_t high) {
    DEMAND(low <= high, low, high);
    const std::uint64_t count =
        static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
    if (count == 0) return static_cast<std::int64_t>(Next());  // all integers
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + Below(count));
  }

  /// Uniform in [0, 1): one draw divided by 2^64.
  double Unit() {
    constexpr double kTwoTo64 = 18446744073709551616.0;
    constexpr double kBelowOne = 0x1.fffffffffffffp-1;
    const double value = static_cast<double>(Next()) / kTwoTo64;
    return value < 1.0 ? value : kBelowOne;
  }

  /// True with the given probability; always consumes one draw.
  bool Chance(double probability) { return Unit() < probability; }

  /// Permutes in place with the pairwise variant of Fisher-Yates from libstdc++ (one draw gives two
  /// swaps), so that labmaze's layouts come out character for character.
  template <class T>
  void Shuffle(std::vector<T>& items) {
    if (items.size() < 2) return;
    const auto draw = [this](std::size_t high) {
      return static_cast<std::size_t>(Uniform(0, static_cast<std::int64_t>(high)));
    };
    std::size_t i = 1;
    if (items.size() % 2 == 0) std::swap(items[i++], items[draw(1)]);
    for (; i < items.size(); i += 2) {
      const std::size_t range = i + 1;
      const std::size_t z = draw(range * (range + 1) - 1);
      std::swap(items[i], items[z / (range + 1)]);
      std::swap(items[i + 1], items[z % (range + 1)]);
    }
  }

 private:
  __extension__ using Uint128 = unsigned __int128;

  /// Uniform in [0, count), count > 0.
  std::uint64_t Below(std::uint64_t count) {
    Uint128 product = static_cast<Uint128>(Next()) * count;
    if (static_cast<std::uint64_t>(product) < count) {
      const std::uint64_t threshold = (0 - count) % count;
      while (static_cast<std::uint64_t>(product) < threshold) {
        product = static_cast<Uint128>(Next()) * count;
      }
    }
    return static_cast<std::uint64_t>(product >> 64);
  }

  std::mt19937_64 engine_;
};

/// SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA
/// 2014): random numbers for inner loops, a few instructions a draw, the same on every platform.
/// Seed it from a Random. Threads: not synchronised; one per thread.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// One draw as two independent numbers of 32 bits.
  struct Halves {
    std::uint32_t upper;
    std::uint32_t lower;
  };
  Halves NextHalves() {
    const std::uint64_t draw = Next();
    return {static_cast<std::uint32_t>(draw >> 32), static_cast<std::uint32_t>(draw)};
  }

 private:
  std::uint64_t state_;
};

/// Derives an independent seed for a named purpose, so that adding one random source does not shift
/// the draws of another.
inline std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t purpose) {
  return SplitMix64(seed + 0x9e3779b97f4a7c15ULL * purpose).Next();
}

/// A number in [0, count) from 32 random bits, by multiplication; uneven by count / 2^32 at most.
inline std::uint32_t ScaledTo(std::uint32_t bits, std::uint32_t count) {
  return static_cast<std::uint32_t>((std::uint64_t{bits} * count) >> 32);
}

/// 32 random bits are below this value with `probability` in [0, 1]; always for 1.
inline std::uint64_t BitsBelow(double probability) {
  return static_cast<std::uint64_t>(std::llround(probability * 4294967296.0));
}

}  // namespace conav
