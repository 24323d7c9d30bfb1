#include "nhpm/engine/kernel_templates.h"
#include "nhpm/engine/kernels.h"

namespace conav::nhpm {
namespace {

/// Loops over lanes that any compiler turns into what its target has (SSE2, NEON, ...).
struct Portable {
  struct Vector {
    float lane[kLanes];
  };
  static constexpr int kWidth = kLanes;
  static constexpr int kTile = 4;
  template <class Function>
  static Vector Each(Function&& function) {
    Vector result;
    for (int i = 0; i < kLanes; ++i) result.lane[i] = function(i);
    return result;
  }
  static Vector Zero() { return {}; }
  static Vector Load(const float* from) {
    return Each([&](int i) { return from[i]; });
  }
  static Vector Broadcast(const float* from) {
    return Each([&](int) { return *from; });
  }
  static void Store(float* to, const Vector& value) {
    for (int i = 0; i < kLanes; ++i) to[i] = value.lane[i];
  }
  static Vector Fma(const Vector& a, const Vector& b, const Vector& c) {
    return Each([&](int i) { return ExactFma(a.lane[i], b.lane[i], c.lane[i]); });
  }
  static Vector Add(const Vector& a, const Vector& b) {
    return Each([&](int i) { return a.lane[i] + b.lane[i]; });
  }
  static Vector Positive(const Vector& value) {
    return Each([&](int i) { return value.lane[i] > 0.0F ? value.lane[i] : 0.0F; });
  }

  struct Pair {
    Vector of[2];
  };
  static Pair PairZero() { return {}; }
  static Pair PairLoad(const float* from) { return {{Load(from), Load(from + kWidth)}}; }
  static Pair PairRepeat(const float* from) { return {{Load(from), Load(from)}}; }
  static Pair PairFma(const Pair& a, const Pair& b, const Pair& c) {
    return {{Fma(a.of[0], b.of[0], c.of[0]), Fma(a.of[1], b.of[1], c.of[1])}};
  }
  static void PairSum(float* to, const Pair& value) {
    to[0] = Sum(value.of[0]);
    to[1] = Sum(value.of[1]);
  }
  static float Sum(const Vector& value) {
    const float* l = value.lane;
    return ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]));
  }
};

}  // namespace

const KernelSet& PortableKernels(int width) { return KernelSetOf<Portable>(width, "portable"); }

}  // namespace conav::nhpm
