#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "operator/gateway/page_feed.h"
#include "unit/operator/gateway/page_bench.h"

namespace conav::operators {

TEST_CASE("frames come to pages that attend", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  SECTION("frames come to those who attend") {
    bench.PutFrame("r1", "first");
    CHECK_FALSE(bench.Next());
    const auto events = bench.Attend({"r1", "r2"});
    REQUIRE(events.size() == 1);
    CHECK(std::get<PageAttends>(events[0].body).robots == std::set<std::string>{"r1", "r2"});
    const auto frame = bench.NextOne().frame();
    CHECK(frame.robot() == "r1");
    CHECK(frame.jpeg() == "first");
    CHECK(frame.number() == 1);
    CHECK(frame.skipped() == 0);
    CHECK_FALSE(bench.Next());
    bench.Attend({});
    bench.PutFrame("r1");
    CHECK_FALSE(bench.Next());
  }
  SECTION("a slow page gets the newest frame and how many it missed") {
    for (int i = 0; i < 5; ++i) bench.PutFrame("r1");
    bench.Attend({"r1"});
    CHECK(bench.NextOne().frame().skipped() == 0);  // before it attended
    for (int i = 0; i < 4; ++i) bench.PutFrame("r1");
    CHECK(bench.NextOne().frame().skipped() == 3);
    for (int i = 0; i < 3; ++i) bench.PutFrame("r1", "newest");
    const auto frame = bench.NextOne().frame();
    CHECK(frame.skipped() == 5);
    CHECK(frame.number() == 12);
    CHECK(frame.jpeg() == "newest");
    CHECK(bench.feed->TakeFramesSkipped() == 5);
    CHECK(bench.feed->TakeFramesSkipped() == 0);
  }
  SECTION("only the robot that is attended to is seen, and at once") {
    bench.Attend({"r2"});
    for (int i = 0; i < 3; ++i) bench.PutFrame("r1");
    CHECK_FALSE(bench.Next());
    bench.Attend({"r1"});
    CHECK(bench.NextOne().frame().skipped() == 0);
    bench.Attend({"r1"});
    CHECK_FALSE(bench.Next());  // it has that one
  }
}

TEST_CASE("robots take turns on a slow page, and so do frames and updates", "[operator][gateway]") {
  PageBench three;
  three.Join();
  three.Attend({"r1", "r2", "r3"});
  std::string seen;
  for (int i = 0; i < 6; ++i) {
    for (const char* robot : {"r1", "r2", "r3"}) three.PutFrame(robot);
    seen += three.NextOne().frame().robot();
  }
  CHECK(seen == "r1r2r3r1r2r3");
  PageBench bench;
  bench.Join();
  bench.Attend({"r1"});
  std::string kinds;
  for (int i = 0; i < 6; ++i) {
    bench.PutFrame("r1");
    bench.PutDue("a", "more");
    kinds += bench.NextOne().has_frame() ? 'f' : 'u';
  }
  CHECK(kinds == "ufufuf");
}

namespace {

constexpr auto kLimit = PageFeed::kUntakenLimit;

console::Hello TakingHello() {
  console::Hello hello = PageBench::Hello();
  hello.set_says_taken(true);
  return hello;
}

void Taken(PageBench& bench, std::uint64_t messages) {
  CHECK(bench.Send(fmt::format("taken {{ messages: {} }}", messages)).empty());
}

/// Puts update after update, as time goes on; how many messages the page gets.
std::uint64_t Pass(PageBench& bench, int updates) {
  std::uint64_t messages = 0;
  for (int i = 0; i < updates; ++i) {
    bench.PutDue("a", fmt::format("{}", i));
    messages += bench.Drain().size();
  }
  return messages;
}

}  // namespace

TEST_CASE(
    "a page that shows nothing gets only a few messages, one that does not confirm everything",
    "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());  // the first one
  bench.Attend({"r1"});
  CHECK(Pass(bench, 10) == kLimit - 1);
  bench.PutFrame("r1");
  CHECK(Pass(bench, 10) == 0);
  CHECK_FALSE(bench.feed->due());
  PageBench silent;
  silent.Join();
  CHECK(Pass(silent, 10) == 10);
}

TEST_CASE("a page that confirms gets more when it has shown what it got", "[operator][gateway]") {
  PageBench bench;
  bench.Join(TakingHello());
  SECTION("a page that has shown what it got gets what is newest then") {
    Pass(bench, 10);
    Taken(bench, 1);
    const auto updates = bench.NextOne().updates();
    REQUIRE(updates.update_size() == 1);
    CHECK(updates.update(0).service().message() == "9");
    CHECK(Pass(bench, 10) == 0);
    Taken(bench, kLimit + 1);
    CHECK(Pass(bench, 10) == kLimit);
  }
  SECTION("frames count as updates do, answers do not") {
    bench.Attend({"r1"});
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
  SECTION("a confirmation of messages that were never sent does not count") {
    Taken(bench, kLimit + 1);
    CHECK(Pass(bench, 10) == kLimit - 1);
    Taken(bench, kLimit);
    Taken(bench, 1);
    CHECK(Pass(bench, 10) == kLimit);
  }
}

TEST_CASE("telling what was taken is no message too many, repeating it is", "[operator][gateway]") {
  PageBench bench;
  bench.options.message_rate = 1.0;
  bench.options.message_burst = 4;
  bench.Connect();
  bench.Join(TakingHello());
  const auto arrives = [&](std::uint64_t messages) {
    Taken(bench, messages);
    return bench.feed->fault().empty();
  };
  for (std::uint64_t i = 1; i <= 20; ++i) {
    CHECK(arrives(i));
    bench.PutFrame("r1");
    bench.updates.Put("a", Said("a", fmt::format("{}", i)));
    bench.clock.Advance(std::chrono::milliseconds(40));
    CHECK(bench.Drain().size() == 1);
  }
  int repeats = 0;
  while (repeats < 10 && arrives(20)) ++repeats;
  CHECK(repeats < 10);
}

TEST_CASE("a burst is allowed, then so many per second, a long silence saves up one burst",
          "[operator][gateway]") {
  using std::chrono::milliseconds;
  FakeClock clock;
  RateLimit limit(10.0, 5, clock.Now());
  // After 50 ms half a message was left.
  for (const auto& [pause, expected] : {std::pair(milliseconds(0), 5),
                                        {milliseconds(250), 2},
                                        {milliseconds(50), 1},
                                        {milliseconds(3'600'000), 5}}) {
    clock.Advance(pause);
    int allowed = 0;
    for (int i = 0; i < 100; ++i) allowed += limit.Allow(clock.Now()) ? 1 : 0;
    CHECK(allowed == expected);
  }
}

}  // namespace conav::operators
