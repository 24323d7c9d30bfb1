#pragma once

#include <functional>

namespace conav {

/// Calls task(worker, index) once for each index in [0, count), on `threads` threads at most (the
/// caller's is one of them), and returns when all are done. worker is in [0, threads) and never at
/// work on two indices at once; which worker takes which index is up to the machine.
/// A task must not throw: on another thread than the caller's that ends the process.
void RunOnWorkers(int threads, int count, const std::function<void(int worker, int index)>& task);

}  // namespace conav
