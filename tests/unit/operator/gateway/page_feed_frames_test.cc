#include "unit/operator/gateway/page_bench.h"

namespace conav::operators {

TEST_CASE("frames come to those who attend", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  bench.PutFrame("r1", "first");
  CHECK_FALSE(bench.Next());
  bench.Attend("r1");
  const auto frame = bench.NextOne().frame();
  CHECK(frame.robot() == "r1");
  CHECK(frame.jpeg() == "first");
  CHECK(frame.number() == 1);
  CHECK(frame.skipped() == 0);
  CHECK_FALSE(bench.Next());
  bench.Attend("", false);
  bench.PutFrame("r1");
  CHECK_FALSE(bench.Next());
}

TEST_CASE("a slow page gets the newest frame and how many it missed", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  for (int i = 0; i < 5; ++i) bench.PutFrame("r1");
  bench.Attend("");
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

TEST_CASE("robots take turns on a slow page", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  bench.Attend("");
  std::string seen;
  for (int i = 0; i < 6; ++i) {
    for (const char* robot : {"r1", "r2", "r3"}) bench.PutFrame(robot);
    seen += bench.NextOne().frame().robot();
  }
  CHECK(seen == "r1r2r3r1r2r3");
}

TEST_CASE("only the robot that is attended to is seen, and at once", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  bench.Attend("r2");
  for (int i = 0; i < 3; ++i) bench.PutFrame("r1");
  CHECK_FALSE(bench.Next());
  bench.Attend("r1");
  CHECK(bench.NextOne().frame().skipped() == 0);
  bench.Attend("r1");
  CHECK_FALSE(bench.Next());  // it has that one
}

TEST_CASE("frames and updates take turns on a slow page", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  bench.Attend("");
  std::string kinds;
  for (int i = 0; i < 6; ++i) {
    bench.updates.Put("a", Said("a", "more"));
    bench.PutFrame("r1");
    bench.clock.Advance(std::chrono::seconds(1));
    kinds += bench.NextOne().has_frame() ? 'f' : 'u';
  }
  CHECK(kinds == "ufufuf");
}

}  // namespace conav::operators
