#include "nhpm/engine/kernels.h"

#include "common/runtime/demand.h"
#include "nhpm/engine/kernel_sets.h"

namespace conav::nhpm {

std::vector<InstructionSet> AvailableInstructionSets() {
#ifdef CONAV_HAVE_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return {InstructionSet::kAvx2, InstructionSet::kPortable};
  }
#endif
  return {InstructionSet::kPortable};
}

const KernelSet& KernelsFor(int width, InstructionSet set) {
  DEMAND(IsNetworkWidth(width), width);
#ifdef CONAV_HAVE_AVX2
  if (set == InstructionSet::kAvx2) return Avx2Kernels(width);
#endif
  DEMAND(set == InstructionSet::kPortable);
  return PortableKernels(width);
}

const KernelSet& KernelsFor(int width) {
  return KernelsFor(width, AvailableInstructionSets().front());
}

}  // namespace conav::nhpm
