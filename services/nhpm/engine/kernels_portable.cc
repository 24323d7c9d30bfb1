#include "nhpm/engine/exact_fma.h"
#include "nhpm/engine/kernel_sets.h"
#include "nhpm/engine/kernel_templates.h"

namespace conav::nhpm {
namespace {

/// Loops over lanes that any compiler turns into what its target has (SSE2, NEON, ...).
struct Portable {
  struct Vector {
    float lane[kLanes];
  };
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
  static float Sum(const Vector& value) {
    const float* l = value.lane;
    return ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]));
  }
};

constexpr KernelSet kWidth16 = MakeKernelSet<Portable, 16>("portable");
constexpr KernelSet kWidth32 = MakeKernelSet<Portable, 32>("portable");
constexpr KernelSet kWidth64 = MakeKernelSet<Portable, 64>("portable");

}  // namespace

const KernelSet& PortableKernels(int width) {
  return width == 16 ? kWidth16 : width == 32 ? kWidth32 : kWidth64;
}

}  // namespace conav::nhpm
