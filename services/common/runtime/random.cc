#include "common/runtime/random.h"

#include "common/runtime/demand.h"

namespace conav {

__extension__ using Uint128 = unsigned __int128;

std::int64_t Random::Uniform(std::int64_t low, std::int64_t high) {
  DEMAND(low <= high, low, high);
  const std::uint64_t count =
      static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
  if (count == 0) return static_cast<std::int64_t>(Next());
  Uint128 product = static_cast<Uint128>(Next()) * count;
  if (static_cast<std::uint64_t>(product) < count) {
    const std::uint64_t threshold = (0 - count) % count;
    while (static_cast<std::uint64_t>(product) < threshold) {
      product = static_cast<Uint128>(Next()) * count;
    }
  }
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) +
                                   static_cast<std::uint64_t>(product >> 64));
}

double Random::Unit() {
  constexpr double kTwoTo64 = 18446744073709551616.0;
  constexpr double kBelowOne = 0x1.fffffffffffffp-1;
  const double value = static_cast<double>(Next()) / kTwoTo64;
  return value < 1.0 ? value : kBelowOne;
}

std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t purpose) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (purpose + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace conav
