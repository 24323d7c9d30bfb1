#pragma once

#include <bit>
#include <cstdint>

namespace conav::nhpm {

/// a * b + c, rounded once: the same bits as the processor's fused multiply-add, for finite values,
/// on machines that have none.
///
/// The product of two floats is exact as a double. Their sum with `c` is rounded to odd (S. Boldo
/// and G. Melquiond, "Emulation of FMA and correctly rounded sums: proved algorithms using rounding
/// to odd", IEEE Transactions on Computers 57(4), 2008), so that the conversion to float rounds as
/// if the sum were exact. Without branches: compilers vectorise it.
inline float EmulatedFma(float a, float b, float c) {
  const double product = static_cast<double>(a) * static_cast<double>(b);
  const double addend = static_cast<double>(c);
  const double sum = product + addend;
  const double part = sum - product;
  const double error = (product - (sum - part)) + (addend - part);
  const auto bits = std::bit_cast<std::int64_t>(sum);
  const std::int64_t away_from_zero = (error > 0.0) == (sum > 0.0) ? 1 : -1;
  const bool nudge = error != 0.0 && (bits & 1) == 0;
  return static_cast<float>(std::bit_cast<double>(bits + (nudge ? away_from_zero : 0)));
}

/// The processor's own where it is fast, else emulated.
inline float ExactFma(float a, float b, float c) {
#ifdef __FP_FAST_FMAF
  return __builtin_fmaf(a, b, c);
#else
  return EmulatedFma(a, b, c);
#endif
}

}  // namespace conav::nhpm
