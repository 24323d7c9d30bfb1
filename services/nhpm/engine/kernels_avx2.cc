#include <immintrin.h>

#include "nhpm/engine/kernel_templates.h"
#include "nhpm/engine/kernels.h"

namespace conav::nhpm {
namespace {

struct Avx2 {
  using Vector = __m256;
  static constexpr int kWidth = 8;
  static constexpr int kTile = 6;
  static Vector Zero() { return _mm256_setzero_ps(); }
  static Vector Load(const float* from) { return _mm256_loadu_ps(from); }
  static Vector Broadcast(const float* from) { return _mm256_broadcast_ss(from); }
  static void Store(float* to, Vector value) { _mm256_storeu_ps(to, value); }
  static Vector Fma(Vector a, Vector b, Vector c) { return _mm256_fmadd_ps(a, b, c); }
  static Vector Add(Vector a, Vector b) { return _mm256_add_ps(a, b); }
  static Vector Positive(Vector value) { return _mm256_max_ps(value, _mm256_setzero_ps()); }

  struct Pair {
    Vector of[2];
  };
  static Pair PairZero() { return {{Zero(), Zero()}}; }
  static Pair PairLoad(const float* from) { return {{Load(from), Load(from + kWidth)}}; }
  static Pair PairRepeat(const float* from) { return {{Load(from), Load(from)}}; }
  static Pair PairFma(const Pair& a, const Pair& b, const Pair& c) {
    return {{Fma(a.of[0], b.of[0], c.of[0]), Fma(a.of[1], b.of[1], c.of[1])}};
  }
  static void PairSum(float* to, const Pair& value) {
    to[0] = Sum(value.of[0]);
    to[1] = Sum(value.of[1]);
  }
  static float Sum(Vector value) {
    const __m128 fours = _mm_add_ps(_mm256_castps256_ps128(value), _mm256_extractf128_ps(value, 1));
    const __m128 twos = _mm_add_ps(fours, _mm_movehl_ps(fours, fours));
    return _mm_cvtss_f32(_mm_add_ss(twos, _mm_movehdup_ps(twos)));
  }
};

}  // namespace

const KernelSet& Avx2Kernels(int width) { return KernelSetOf<Avx2>(width, "avx2"); }

}  // namespace conav::nhpm
