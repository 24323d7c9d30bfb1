#pragma once

namespace conav::bench {

/// What one core does at most, GFLOP/s (an FMA counts as two): the widest vectors that it has, in
/// registers, no memory. About 10 ms of processor time. 0 where the processor has no AVX2.
double MeasureFmaPeak();

/// The sum over as many threads at once: two of them may share one core.
double MeasureFmaPeak(int threads);

}  // namespace conav::bench
