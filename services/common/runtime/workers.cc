#include "common/runtime/workers.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace conav {

void RunOnWorkers(int threads, int count, const std::function<void(int, int)>& task) {
  std::atomic<int> next{0};
  const auto work = [&](int worker) {
    for (int index = next++; index < count; index = next++) task(worker, index);
  };
  std::vector<std::jthread> others;
  for (int worker = 1; worker < std::min(threads, count); ++worker) {
    others.emplace_back(work, worker);
  }
  work(0);
}

}  // namespace conav
