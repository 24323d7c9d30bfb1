#include "nhpm/engine/kernels.h"

#include <algorithm>

#include "common/runtime/result.h"

namespace conav::nhpm {

std::vector<InstructionSet> AvailableInstructionSets() {
  std::vector<InstructionSet> sets;
#ifdef CONAV_HAVE_X86_KERNELS
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (avx2 && __builtin_cpu_supports("avx512f")) sets.push_back(InstructionSet::kAvx512);
  if (avx2) sets.push_back(InstructionSet::kAvx2);
#endif
  sets.push_back(InstructionSet::kPortable);
  return sets;
}

const KernelSet& KernelsFor(int width, InstructionSet set) {
  DEMAND(IsNetworkWidth(width), width);
  const auto sets = AvailableInstructionSets();
  DEMAND(std::find(sets.begin(), sets.end(), set) != sets.end(), static_cast<int>(set));
#ifdef CONAV_HAVE_X86_KERNELS
  if (set == InstructionSet::kAvx512) return Avx512Kernels(width);
  if (set == InstructionSet::kAvx2) return Avx2Kernels(width);
#endif
  return PortableKernels(width);
}

const KernelSet& KernelsFor(int width) {
  return KernelsFor(width, AvailableInstructionSets().front());
}

}  // namespace conav::nhpm
