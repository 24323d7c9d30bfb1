#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace conav {

/// Seeded random numbers that are the same on every platform and standard library.
///
/// std::mt19937_64 is fixed by the C++ standard, its distributions are not; so the distributions
/// are written out here. Bounded integers use Lemire's multiply-and-reject method (D. Lemire, "Fast
/// Random Integer Generation in an Interval", ACM TOMACS 29(1), 2019), the choice of libstdc++
/// >= 11. Threads: not synchronised; one per thread.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// One raw draw.
  std::uint64_t Next() { return engine_(); }

  /// Uniform integer in [low, high], both ends included. Requires low <= high.
  std::int64_t Uniform(std::int64_t low, std::int64_t high);

  /// Uniform in [0, 1): one draw divided by 2^64.
  double Unit();

  /// True with the given probability; always consumes one draw.
  bool Chance(double probability) { return Unit() < probability; }

  /// Permutes in place: the pairwise variant of Fisher-Yates that libstdc++ uses (one draw gives
  /// two swaps), so that labmaze's layouts come out character for character.
  template <class T>
  void Shuffle(std::vector<T>& items) {
    ForEachSwap(items.size(), [&](std::size_t a, std::size_t b) { std::swap(items[a], items[b]); });
  }

 private:
  template <class Swap>
  void ForEachSwap(std::size_t size, Swap&& swap);

  std::mt19937_64 engine_;
};

/// Derives an independent seed for a named purpose, so that adding one random source does not shift
/// the draws of another (SplitMix64 finaliser over seed and purpose).
std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t purpose);

template <class Swap>
void Random::ForEachSwap(std::size_t size, Swap&& swap) {
  if (size < 2) return;
  std::size_t i = 1;
  const auto draw = [this](std::size_t high) {
    return static_cast<std::size_t>(Uniform(0, static_cast<std::int64_t>(high)));
  };
  if (size % 2 == 0) {
    swap(1, draw(1));
    i = 2;
  }
  for (; i < size; i += 2) {
    const std::size_t range = i + 1;
    const std::size_t z = draw(range * (range + 1) - 1);
    swap(i, z / (range + 1));
    swap(i + 1, z % (range + 1));
  }
}

}  // namespace conav
