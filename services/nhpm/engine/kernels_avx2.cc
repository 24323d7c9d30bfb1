#include "nhpm/engine/kernel_sets.h"
#include "nhpm/engine/kernel_templates.h"
#include "nhpm/engine/vector_avx2.h"

namespace conav::nhpm {

const KernelSet& Avx2Kernels(int width) { return KernelSetOf<Avx2>(width, "avx2"); }

}  // namespace conav::nhpm
