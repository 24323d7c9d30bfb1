#include "common/runtime/threads.h"

#include <algorithm>
#include <csignal>
#include <thread>
#include <vector>

namespace conav {
namespace {

// A signal handler can reach only what is global.
StopToken process_stop_token;

void HandleSignal(int) { process_stop_token.RequestStop(); }

}  // namespace

StopToken& ProcessStopToken() { return process_stop_token; }

void InstallStopSignals() {
  std::signal(SIGINT, HandleSignal);
  std::signal(SIGTERM, HandleSignal);
  std::signal(SIGPIPE, SIG_IGN);
}

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
