#include <immintrin.h>

#include "nhpm/engine/kernel_sets.h"
#include "nhpm/engine/kernel_templates.h"

namespace conav::nhpm {
namespace {

struct Avx2 {
  using Vector = __m256;
  static Vector Zero() { return _mm256_setzero_ps(); }
  static Vector Load(const float* from) { return _mm256_loadu_ps(from); }
  static Vector Broadcast(const float* from) { return _mm256_broadcast_ss(from); }
  static void Store(float* to, Vector value) { _mm256_storeu_ps(to, value); }
  static Vector Fma(Vector a, Vector b, Vector c) { return _mm256_fmadd_ps(a, b, c); }
  static Vector Add(Vector a, Vector b) { return _mm256_add_ps(a, b); }
  static Vector Positive(Vector value) { return _mm256_max_ps(value, _mm256_setzero_ps()); }
  static float Sum(Vector value) {
    const __m128 fours = _mm_add_ps(_mm256_castps256_ps128(value), _mm256_extractf128_ps(value, 1));
    const __m128 twos = _mm_add_ps(fours, _mm_movehl_ps(fours, fours));
    return _mm_cvtss_f32(_mm_add_ss(twos, _mm_movehdup_ps(twos)));
  }
};

constexpr KernelSet kWidth16 = MakeKernelSet<Avx2, 16>("avx2");
constexpr KernelSet kWidth32 = MakeKernelSet<Avx2, 32>("avx2");
constexpr KernelSet kWidth64 = MakeKernelSet<Avx2, 64>("avx2");

}  // namespace

const KernelSet& Avx2Kernels(int width) {
  return width == 16 ? kWidth16 : width == 32 ? kWidth32 : kWidth64;
}

}  // namespace conav::nhpm
