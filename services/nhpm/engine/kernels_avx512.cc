#include <immintrin.h>

#include "nhpm/engine/kernel_templates.h"
#include "nhpm/engine/kernels.h"

namespace conav::nhpm {
namespace {

struct Avx512 {
  using Vector = __m512;
  static constexpr int kWidth = 16;
  static constexpr int kTile = 9;
  static Vector Zero() { return _mm512_setzero_ps(); }
  static Vector Load(const float* from) { return _mm512_loadu_ps(from); }
  static Vector Broadcast(const float* from) { return _mm512_set1_ps(*from); }
  static void Store(float* to, Vector value) { _mm512_storeu_ps(to, value); }
  static Vector Fma(Vector a, Vector b, Vector c) { return _mm512_fmadd_ps(a, b, c); }
  static Vector Add(Vector a, Vector b) { return _mm512_add_ps(a, b); }
  /// The mask of all lanes avoids a false warning of g++ 12.
  static Vector Positive(Vector value) {
    return _mm512_maskz_max_ps(0xFFFF, value, _mm512_setzero_ps());
  }

  using Pair = __m512;  // the lower half for the first output, the upper for the second
  static Pair PairZero() { return Zero(); }
  static Pair PairLoad(const float* from) { return Load(from); }
  static Pair PairRepeat(const float* from) {
    const __m256d eight = _mm256_castps_pd(_mm256_loadu_ps(from));
    return _mm512_castpd_ps(_mm512_maskz_broadcast_f64x4(0xFF, eight));
  }
  static Pair PairFma(Pair a, Pair b, Pair c) { return Fma(a, b, c); }
  static void PairSum(float* to, Pair value) {
    constexpr auto kAll = 0xFFFF;  // masks against g++'s warning, as above
    value = Add(value, _mm512_maskz_shuffle_f32x4(kAll, value, value, _MM_SHUFFLE(2, 3, 0, 1)));
    value = Add(value, _mm512_maskz_shuffle_ps(kAll, value, value, _MM_SHUFFLE(1, 0, 3, 2)));
    value = Add(value, _mm512_maskz_shuffle_ps(kAll, value, value, _MM_SHUFFLE(2, 3, 0, 1)));
    to[0] = _mm512_cvtss_f32(value);
    to[1] = _mm_cvtss_f32(_mm512_maskz_extractf32x4_ps(0xF, value, 2));
  }
};

}  // namespace

const KernelSet& Avx512Kernels(int width) { return KernelSetOf<Avx512>(width, "avx512"); }

}  // namespace conav::nhpm
