#include <catch2/catch.hpp>
#include <thread>

#include "nhpm/nhpm_service.h"

namespace conav::nhpm {
namespace {

using std::chrono::milliseconds;
using Admission = RequestQueue::Admission;

/// About a grid of `cells`.
OpenRequest Request(std::uint64_t id, int cells = 1, std::uint32_t timeout_ms = 0) {
  OpenRequest open;
  open.request.client = "planner-1";
  open.request.request_id = id;
  open.request.timeout_ms = timeout_ms;
  open.request.queries.resize(1);
  open.request.queries[0].belief = BeliefGrid(1, cells, 0.5F);
  return open;
}

/// A queue that knows what a cell costs: 10 ms.
struct Experienced {
  explicit Experienced(int threads = 1) : queue(100, threads) {
    queue.Offer(Request(1000));
    queue.Finish(*queue.Take(), milliseconds(10));
  }
  RequestQueue queue;
};

TEST_CASE("Requests are taken in the order in which they came", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  CHECK_FALSE(queue.Take());
  CHECK(queue.Offer(Request(1)) == Admission::kQueued);
  CHECK(queue.Offer(Request(2)) == Admission::kQueued);
  CHECK(queue.Take()->request.request_id == 1);
  CHECK(queue.Take()->request.request_id == 2);
  CHECK_FALSE(queue.Take());
}

TEST_CASE("A queue is full when its requests wait or are computed, and not after them",
          "[nhpm][queue]") {
  RequestQueue queue(2, 1);
  queue.Offer(Request(1));
  queue.Offer(Request(2));
  const auto first = queue.Take();
  CHECK(queue.open() == 2);
  OpenRequest third = Request(3);
  CHECK(queue.Offer(std::move(third)) == Admission::kFull);
  CHECK(third.request.request_id == 3);  // still there, to be replied to
  queue.Finish(*first, milliseconds(1));
  CHECK(queue.Offer(std::move(third)) == Admission::kQueued);
}

TEST_CASE("A request that is open already is not taken twice", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  queue.Offer(Request(1));
  CHECK(queue.Offer(Request(1)) == Admission::kRepeat);
  const auto taken = queue.Take();
  CHECK(queue.Offer(Request(1)) == Admission::kRepeat);  // while it is computed
  CHECK_FALSE(queue.Take());
  queue.Finish(*taken, milliseconds(1));
  CHECK(queue.Offer(Request(1)) == Admission::kQueued);  // answered: once more, alike
  OpenRequest other = Request(1);
  other.request.client = "planner-2";
  CHECK(queue.Offer(std::move(other)) == Admission::kQueued);
}

TEST_CASE("A repeat lends its later deadline to the request that waits", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  queue.Offer(Request(1, 1, 100));
  OpenRequest repeat = Request(1, 1, 70);
  repeat.arrived += milliseconds(60);
  queue.Offer(std::move(repeat));
  CHECK(queue.Take()->deadline() == Clock::TimePoint{} + milliseconds(130));
}

TEST_CASE("A request without a timeout has no deadline", "[nhpm][queue]") {
  CHECK_FALSE(Request(1).deadline());
}

TEST_CASE("Before anything was computed every deadline is tried", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  CHECK(queue.Offer(Request(1, 1000, 1)) == Admission::kQueued);
}

TEST_CASE("What would be answered after its deadline is not queued", "[nhpm][queue]") {
  Experienced bench;
  CHECK(bench.queue.Offer(Request(1, 3, 30)) == Admission::kQueued);
  CHECK(bench.queue.ExpectedWait(1) == milliseconds(40));
  CHECK(bench.queue.Offer(Request(2, 1, 39)) == Admission::kTooSlow);
  CHECK(bench.queue.Offer(Request(2, 1, 40)) == Admission::kQueued);
  CHECK(bench.queue.Offer(Request(3, 100)) == Admission::kQueued);  // it does not say
}

TEST_CASE("A slow answer turns nobody away while nothing is open", "[nhpm][queue]") {
  Experienced bench;
  CHECK(bench.queue.Offer(Request(1, 1, 5)) == Admission::kQueued);
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kTooSlow);
  const auto taken = bench.queue.Take();
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kTooSlow);  // while 1 is computed
  bench.queue.Finish(*taken, milliseconds(10));
  CHECK(bench.queue.Offer(Request(2, 1, 5)) == Admission::kQueued);
}

TEST_CASE("A request costs the cells of all its queries", "[nhpm][queue]") {
  OpenRequest open = Request(1, 12);
  open.request.queries.push_back(open.request.queries[0]);
  CHECK(open.cells() == 24);
}

TEST_CASE("More threads share what is ahead, but one computes a request", "[nhpm][queue]") {
  Experienced bench(2);
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(40));
  bench.queue.Offer(Request(1, 6));
  CHECK(bench.queue.ExpectedWait(4) == milliseconds(70));
}

TEST_CASE("What was not computed says nothing of the time that it takes", "[nhpm][queue]") {
  Experienced bench;
  bench.queue.Offer(Request(1));
  bench.queue.Finish(*bench.queue.Take(), std::nullopt);
  CHECK(bench.queue.ExpectedWait(1) == milliseconds(10));
  CHECK(bench.queue.open() == 0);
}

TEST_CASE("A closed queue gives what is left, then nothing", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  queue.Offer(Request(1));
  queue.Close();
  CHECK(queue.WaitAndTake()->request.request_id == 1);
  CHECK_FALSE(queue.WaitAndTake());
}

TEST_CASE("A waiting thread gets the request that comes", "[nhpm][queue]") {
  RequestQueue queue(4, 1);
  std::optional<OpenRequest> taken;
  std::thread worker([&] { taken = queue.WaitAndTake(); });
  queue.Offer(Request(7));
  worker.join();
  REQUIRE(taken);
  CHECK(taken->request.request_id == 7);
}

}  // namespace
}  // namespace conav::nhpm
