#pragma once

namespace conav::bench {

/// Floats in the widest vector that this processor multiplies and adds: 16, 8, or 0 without AVX2.
int WidestFmaLanes();

/// What one core does at most with vectors of `lanes` floats (WidestFmaLanes() or fewer), GFLOP/s
/// (an FMA counts as two), in registers, no memory. About 10 ms of processor time. 0 for 0 lanes.
double MeasureFmaPeak(int lanes);

/// With the widest vectors, the sum over as many threads at once: two of them may share one core.
double MeasureFmaPeakOfThreads(int threads);

}  // namespace conav::bench
