#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace conav::nhpm {

/// Calls `work(i)` for each i in [0, count) on up to `threads` threads (at least one); which thread
/// takes which i is open, so each call must write to places of its own.
template <class Work>
void ParallelFor(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads && static_cast<std::size_t>(i) < count; ++i) {
    helpers.emplace_back(take);
  }
  take();
}

}  // namespace conav::nhpm
