#include <numeric>
#include <thread>

#include "bench/support/bench_program.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace conav::bench {

#if defined(__x86_64__)
namespace {

constexpr int kSums = 12;  // more than latency times units, so that none waits
constexpr int kTurns = 3'000'000;

double Gflops(int lanes, double seconds) { return 1e-9 * 2.0 * lanes * kSums * kTurns / seconds; }

__attribute__((target("avx2,fma"))) double PeakOfAvx2() {
  __m256 sums[kSums];
  for (auto& sum : sums) sum = _mm256_set1_ps(1.0F);
  __m256 a = _mm256_set1_ps(0.999F);
  __m256 b = _mm256_set1_ps(0.001F);
  asm volatile("" : "+x"(a), "+x"(b));  // unknown to the compiler
  const double start = ThreadSeconds();
  for (int turn = 0; turn < kTurns; ++turn) {
#pragma GCC unroll 12
    for (auto& sum : sums) sum = _mm256_fmadd_ps(sum, a, b);
  }
  for (auto& sum : sums) asm volatile("" : : "x"(sum));
  return Gflops(8, ThreadSeconds() - start);
}

__attribute__((target("avx512f"))) double PeakOfAvx512() {
  __m512 sums[kSums];
  for (auto& sum : sums) sum = _mm512_set1_ps(1.0F);
  __m512 a = _mm512_set1_ps(0.999F);
  __m512 b = _mm512_set1_ps(0.001F);
  asm volatile("" : "+v"(a), "+v"(b));
  const double start = ThreadSeconds();
  for (int turn = 0; turn < kTurns; ++turn) {
#pragma GCC unroll 12
    for (auto& sum : sums) sum = _mm512_fmadd_ps(sum, a, b);
  }
  for (auto& sum : sums) asm volatile("" : : "v"(sum));
  return Gflops(16, ThreadSeconds() - start);
}

}  // namespace

int WidestFmaLanes() {
  if (__builtin_cpu_supports("avx512f")) return 16;
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? 8 : 0;
}

double MeasureFmaPeak(int lanes) {
  if (lanes == 0) return 0.0;
  return lanes == 16 ? PeakOfAvx512() : PeakOfAvx2();
}
#else
int WidestFmaLanes() { return 0; }

double MeasureFmaPeak(int) { return 0.0; }
#endif

double MeasureFmaPeakOfThreads(int threads) {
  std::vector<double> peaks(static_cast<std::size_t>(threads), 0.0);
  std::vector<std::thread> running;
  for (double& peak : peaks) {
    running.emplace_back([&peak] { peak = MeasureFmaPeak(WidestFmaLanes()); });
  }
  for (std::thread& thread : running) thread.join();
  return std::accumulate(peaks.begin(), peaks.end(), 0.0);
}

}  // namespace conav::bench
