// Robots that meet where only one fits.
#include "unit/planner/decision/crowd.h"

using namespace conav;
using namespace conav::planner;

namespace {

constexpr int kRounds = 1000;

CrowdOptions DrawnOptions() {
  CrowdOptions options;
  options.method = GENERATE("ig-mcts", "instruction", "greedy");
  options.map_is_known = GENERATE(true, false);
  options.seed = GENERATE(range(0, 10));
  return options;
}

void AllArrive(const std::vector<std::string>& rows, const CrowdOptions& options = DrawnOptions(),
               const std::string& silent = "") {
  CAPTURE(options.method, options.map_is_known, options.seed);
  Crowd crowd(rows, options, silent);
  const bool arrived = crowd.RunsToTheEnd(kRounds);
  INFO(crowd.Snapshot());
  CHECK(arrived);
}

}  // namespace

TEST_CASE("two meet head-on in a corridor with a side pocket", "[planner][traffic]") {
  AllArrive({"#########",  //
             "#1b   a2#",  //
             "#### ####",  //
             "#########"});
}

TEST_CASE("two meet head-on in a corridor without pockets between two rooms",
          "[planner][traffic]") {
  AllArrive({"###########",  //
             "#1 #####a #",  //
             "# b     2 #",  //
             "###########"});
}

TEST_CASE("the one that goes before wants into the dead end out of which the other wants",
          "[planner][traffic]") {
  AllArrive({"##########",  //
             "#1b#######",  //
             "#      a2#",  //
             "##########"});
}

TEST_CASE("a robot has its goal in a dead end behind one that has none", "[planner][traffic]") {
  AllArrive({"##########",  //
             "#  #######",  //
             "#1     2a#",  //
             "##########"});
}

TEST_CASE("a robot has its goal in a dead end behind one that goes before but has no goals",
          "[planner][traffic]") {
  AllArrive({"##########",  //
             "#  #######",  //
             "#2     1b#",  //
             "##########"});
}

TEST_CASE("three meet in a corridor with a side pocket at each end", "[planner][traffic]") {
  AllArrive({"###########",  //
             "#1 3b   a2#",  //
             "## ### #c##",  //
             "###########"});
}

TEST_CASE("three in a corridor without pockets, with rooms at the ends", "[planner][traffic]") {
  AllArrive({"############",  //
             "#1 c####a3 #",  //
             "#2       b #",  //
             "############"});
}

TEST_CASE("four exchange their places around a ring with one pocket", "[planner][traffic]") {
  AllArrive({"#########",  //
             "#1d   c2#",  //
             "# ##### #",  //
             "#3b   a4#",  //
             "#### ####",  //
             "#########"});
}

TEST_CASE("a robot that waits for its operator in the corridor makes room", "[planner][traffic]") {
  // r2's operator says nothing: it stands in the corridor until it makes room for r1.
  CrowdOptions options;
  options.method = "instruction";
  Crowd crowd({"##########",  //
               "#1  2   a#",  //
               "##### ####",  //
               "#####b####",  //
               "##########"},
              options, "2");
  for (int round = 0; round < kRounds && !crowd.state("r1").goals_left.empty(); ++round) {
    crowd.RunsToTheEnd(1);
  }
  INFO(crowd.Snapshot());
  CHECK(crowd.state("r1").goals_left.empty());
}

TEST_CASE("two come from one side and one from the other, with one pocket", "[planner][traffic]") {
  AllArrive({"############",  //
             "#c #########",  //
             "#12     ab3#",  //
             "#### #######",  //
             "############"});
}

TEST_CASE("a robot that goes before waits for its operator, and the other cannot pass",
          "[planner][traffic]") {
  // r1's operator says nothing, and r1 wants no way: r2 has to get past all the same.
  CrowdOptions options;
  options.method = "instruction";
  Crowd crowd({"##########",  //
               "#2  1   b#",  //
               "##### ####",  //
               "#####a####",  //
               "##########"},
              options, "1");
  for (int round = 0; round < kRounds && !crowd.state("r2").goals_left.empty(); ++round) {
    crowd.RunsToTheEnd(1);
  }
  INFO(crowd.Snapshot());
  CHECK(crowd.state("r2").goals_left.empty());
}
