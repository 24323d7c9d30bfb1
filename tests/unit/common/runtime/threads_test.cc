#include "common/runtime/threads.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <vector>

namespace conav {
namespace {

TEST_CASE("a stop stays requested, SIGTERM requests the process's", "[runtime]") {
  StopToken token;
  CHECK_FALSE(token.stop_requested());
  for (int i = 0; i < 2; ++i) {
    token.RequestStop();
    CHECK(token.stop_requested());
  }
  InstallStopSignals();
  REQUIRE_FALSE(ProcessStopToken().stop_requested());
  REQUIRE(std::raise(SIGTERM) == 0);
  CHECK(ProcessStopToken().stop_requested());
}

TEST_CASE("Each index is taken once, by a worker that exists", "[runtime]") {
  const int threads = GENERATE(1, 2, 7);
  const int count = GENERATE(0, 1, 5, 100);
  std::vector<std::atomic<int>> taken(100);
  std::atomic<bool> known_workers{true};
  RunOnWorkers(threads, count, [&](int worker, int index) {
    ++taken[static_cast<std::size_t>(index)];
    if (worker < 0 || worker >= threads) known_workers = false;
  });
  CHECK(known_workers);
  for (int i = 0; i < 100; ++i) CHECK(taken[static_cast<std::size_t>(i)] == (i < count ? 1 : 0));
}

}  // namespace
}  // namespace conav
