#include "bench/support/bench_program.h"

#include <catch2/catch.hpp>

namespace conav::bench {
namespace {

struct Ended {
  int exit_code;
  bool has_run;
};

Ended RunWith(std::vector<const char*> words, bool fails = false) {
  BenchProgram program("bench", "", 3);
  words.insert(words.begin(), "bench");
  Ended ended{-1, false};
  ended.exit_code =
      program.Run(static_cast<int>(words.size()), const_cast<char**>(words.data()), [&] {
        ended.has_run = true;
        if (fails) throw std::runtime_error("failed");
      });
  return ended;
}

TEST_CASE("a benchmark ends with 0, and with 1 when it fails", "[bench]") {
  CHECK(RunWith({}).exit_code == 0);
  CHECK(RunWith({}).has_run);
  CHECK(RunWith({}, true).exit_code == 1);
}

TEST_CASE("figures that could not be written are wrong use, found before the benchmark",
          "[bench]") {
  for (const char* file : {"/nonexistent/x", "/proc"}) {
    const Ended ended = RunWith({"--json", file});
    CHECK(ended.exit_code == 2);
    CHECK_FALSE(ended.has_run);
  }
  CHECK(RunWith({"--rounds", "0"}).exit_code == 2);
}

}  // namespace
}  // namespace conav::bench
