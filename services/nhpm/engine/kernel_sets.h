#pragma once

#include "nhpm/engine/kernels.h"

/// One per instruction set, compiled with its own flags; `width` as KernelsFor() says.
namespace conav::nhpm {

const KernelSet& PortableKernels(int width);
const KernelSet& Avx2Kernels(int width);
const KernelSet& Avx512Kernels(int width);

}  // namespace conav::nhpm
