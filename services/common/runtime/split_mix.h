#pragma once

#include <cmath>
#include <cstdint>

namespace conav {

/// SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA
/// 2014): random numbers for innermost loops, a few instructions a draw, the same on every platform.
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

/// A number in [0, count) from 32 random bits, by multiplication; uneven by count / 2^32 at most.
inline std::uint32_t ScaledTo(std::uint32_t bits, std::uint32_t count) {
  return static_cast<std::uint32_t>((std::uint64_t{bits} * count) >> 32);
}

/// 32 random bits are below this with `probability`, in [0, 1]; always with 1.
inline std::uint64_t BitsBelow(double probability) {
  return static_cast<std::uint64_t>(std::llround(probability * 4294967296.0));
}

}  // namespace conav
