#include <fmt/format.h>

#include "unit/operator/gateway/page_bench.h"

namespace conav::operators {
namespace {

constexpr auto kLimit = PageFeed::kUntakenLimit;

console::Hello TakingHello() {
  console::Hello hello = PageBench::Hello();
  hello.set_says_taken(true);
  return hello;
}

void Taken(PageBench& bench, std::uint64_t messages) {
  console::ClientMessage message;
  message.mutable_taken()->set_messages(messages);
  CHECK(bench.Send(message).empty());
}

/// Puts update after update, as time goes on; how many messages the page gets.
std::uint64_t Pass(PageBench& bench, int updates) {
  std::uint64_t messages = 0;
  for (int i = 0; i < updates; ++i) {
    bench.updates.Put("a", Said("a", fmt::format("{}", i)));
    bench.clock.Advance(std::chrono::seconds(1));
    messages += bench.Drain().size();
  }
  return messages;
}

}  // namespace

TEST_CASE("a page that shows nothing gets a few messages, and no more", "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());  // the first one
  bench.Attend("r1");
  CHECK(Pass(bench, 10) == kLimit - 1);
  bench.PutFrame("r1");
  CHECK(Pass(bench, 10) == 0);
  CHECK_FALSE(bench.feed->due());
}

TEST_CASE("a page that has shown what it got gets what is newest then", "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());
  Pass(bench, 10);
  Taken(bench, 1);
  const auto updates = bench.NextOne().updates();
  REQUIRE(updates.update_size() == 1);
  CHECK(updates.update(0).service().message() == "9");
  CHECK(Pass(bench, 10) == 0);
  Taken(bench, kLimit + 1);
  CHECK(Pass(bench, 10) == kLimit);
}

TEST_CASE("frames count as updates do, answers do not", "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());
  bench.Attend("r1");
  for (std::uint64_t i = 1; i < kLimit; ++i) {
    bench.PutFrame("r1");
    CHECK(bench.NextOne().has_frame());
  }
  bench.PutFrame("r1");
  CHECK_FALSE(bench.Next());
  bench.Ping(1.0);
  CHECK(bench.NextOne().has_pong());
  Taken(bench, 2);
  CHECK(bench.NextOne().has_frame());
}

TEST_CASE("what a page cannot have taken does not count", "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());
  Taken(bench, kLimit + 1);
  CHECK(Pass(bench, 10) == kLimit - 1);
  Taken(bench, kLimit);
  Taken(bench, 1);
  CHECK(Pass(bench, 10) == kLimit);
}

TEST_CASE("a page that does not tell gets everything", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  CHECK(Pass(bench, 10) == 10);
}

TEST_CASE("telling what was taken is no message too many, repeating it is", "[operator][gateway]") {
  PageBench bench;
  bench.options.message_rate = 1.0;
  bench.options.message_burst = 4;
  bench.Connect();
  bench.Join(TakingHello());
  const auto tells = [&](std::uint64_t messages) {
    Taken(bench, messages);
    return bench.feed->fault().empty();
  };
  for (std::uint64_t i = 1; i <= 20; ++i) {
    CHECK(tells(i));
    bench.PutFrame("r1");
    bench.updates.Put("a", Said("a", fmt::format("{}", i)));
    bench.clock.Advance(std::chrono::milliseconds(40));
    CHECK(bench.Drain().size() == 1);
  }
  int repeats = 0;
  while (repeats < 10 && tells(20)) ++repeats;
  CHECK(repeats < 10);
}

}  // namespace conav::operators
