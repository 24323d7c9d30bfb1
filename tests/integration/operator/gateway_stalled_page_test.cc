#include <catch2/catch.hpp>

#include "integration/operator/gateway_bench.h"
#include "support/resident_memory.h"

namespace conav::operators {
namespace {

constexpr int kKeys = 40;
constexpr std::size_t kUpdateBytes = 20'000;
constexpr std::size_t kFrameBytes = 60'000;

/// Puts an update and a frame each, while `reader` takes them all.
void Put(GatewayBench& bench, KnowingPage& reader, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const std::string content(kUpdateBytes, static_cast<char>('a' + round % 26));
    bench.updates.Put(std::to_string(round % kKeys), Said(std::to_string(round % kKeys), content));
    console::Frame frame;
    frame.set_robot("r1");
    frame.set_jpeg(std::string(kFrameBytes, static_cast<char>('a' + round % 26)));
    bench.frames.Put(std::move(frame));
    bench.gateway->Notify();
    reader.ReadUpTo(bench.updates.sequence());
  }
}

}  // namespace

TEST_CASE("a page that takes nothing costs the service under 8 MB and the others nothing",
          "[operator][integration]") {
  GatewayBench bench;
  bench.options.update_rate_hz = 1000.0;
  bench.Start();
  KnowingPage reader(bench.Page(), HelloOf('a'));
  REQUIRE(reader.client.Send(MessageOf("attend { robots: 'r1' }")));
  Put(bench, reader, 2 * kKeys);  // the service holds now what it will hold

  KnowingPage stalled(bench.Page(), HelloOf('b'));
  REQUIRE(stalled.client.Send(MessageOf("attend { robots: 'r1' }")));
  const double before = test::ResidentMiB();
  constexpr int kRounds = 1250;
  static_assert(kRounds * (kUpdateBytes + kFrameBytes) >= 100'000'000);
  Put(bench, reader, kRounds);
  const double grown = test::ResidentMiB() - before;
  CAPTURE(before, grown);
  if (test::kMeasuresMemory) CHECK(grown < 8.0);

  CHECK(reader.repeated == 0);
  CHECK(reader.frames > 0);
  CHECK(bench.Pages() == 2);
  // A page that reads again gets the current state.
  stalled.ReadUpTo(bench.updates.sequence());
  CHECK(stalled.known == reader.known);
  CHECK(stalled.repeated == 0);
}

}  // namespace conav::operators
