#include <catch2/catch.hpp>

#include "launcher/progress.h"
#include "unit/deploy/launcher/sample_episode.h"

using namespace conav::launcher;

TEST_CASE("the table tells what a robot did and whether all was reached", "[launcher][table]") {
  const std::string table = ResultTable(Measure(SampleEpisode()));
  CHECK_THAT(table, Catch::Contains("r1    w1         1/1       2      17         1    12.3 kB"));
  CHECK_THAT(table, Catch::Contains("all goals reached: yes"));
}

TEST_CASE("bytes are shortened", "[launcher][table]") {
  CHECK(ShortBytes(0) == "0 B");
  CHECK(ShortBytes(999) == "999 B");
  CHECK(ShortBytes(1000) == "1.0 kB");
  CHECK(ShortBytes(2500000) == "2.5 MB");
}
