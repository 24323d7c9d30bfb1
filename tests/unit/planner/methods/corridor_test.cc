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

struct Meeting {
  const char* name;
  std::vector<std::string> rows;
};

const std::vector<Meeting> kMeetings{
    {"two head-on in a corridor with a side pocket",
     {"#########",  //
      "#1b   a2#",  //
      "#### ####",  //
      "#########"}},
    {"two head-on in a corridor without pockets between two rooms",
     {"###########",  //
      "#1 #####a #",  //
      "# b     2 #",  //
      "###########"}},
    {"the one that goes before wants into the dead end out of which the other wants",
     {"##########",  //
      "#1b#######",  //
      "#      a2#",  //
      "##########"}},
    {"a goal in a dead end behind a robot that has none",
     {"##########",  //
      "#  #######",  //
      "#1     2a#",  //
      "##########"}},
    {"a goal in a dead end behind a robot that goes before but has no goals",
     {"##########",  //
      "#  #######",  //
      "#2     1b#",  //
      "##########"}},
    {"three in a corridor with a side pocket at each end",
     {"###########",  //
      "#1 3b   a2#",  //
      "## ### #c##",  //
      "###########"}},
    {"three in a corridor without pockets, with rooms at the ends",
     {"############",  //
      "#1 c####a3 #",  //
      "#2       b #",  //
      "############"}},
    {"four exchange their places around a ring with one pocket",
     {"#########",  //
      "#1d   c2#",  //
      "# ##### #",  //
      "#3b   a4#",  //
      "#### ####",  //
      "#########"}},
    {"two come from one side and one from the other, with one pocket",
     {"############",  //
      "#c #########",  //
      "#12     ab3#",  //
      "#### #######",  //
      "############"}}};

}  // namespace

TEST_CASE("robots that meet where only one fits all arrive", "[planner][traffic]") {
  const Meeting& meeting = GENERATE(from_range(kMeetings));
  const CrowdOptions options = DrawnOptions();
  CAPTURE(meeting.name, options.method, options.map_is_known, options.seed);
  Crowd crowd(meeting.rows, options);
  const bool arrived = crowd.RunsToTheEnd(kRounds);
  INFO(crowd.Snapshot());
  CHECK(arrived);
}

TEST_CASE("a robot in a corridor whose operator is silent makes room, with either robot first",
          "[planner][traffic]") {
  const auto [rows, silent, other] =
      GENERATE(table<std::vector<std::string>, std::string, std::string>({{{"##########",  //
                                                                            "#1  2   a#",  //
                                                                            "##### ####",  //
                                                                            "#####b####",  //
                                                                            "##########"},
                                                                           "2",
                                                                           "r1"},
                                                                          {{"##########",  //
                                                                            "#2  1   b#",  //
                                                                            "##### ####",  //
                                                                            "#####a####",  //
                                                                            "##########"},
                                                                           "1",
                                                                           "r2"}}));
  CrowdOptions options;
  options.method = "instruction";
  Crowd crowd(rows, options, silent);
  for (int round = 0; round < kRounds && !crowd.state(other).goals_left.empty(); ++round) {
    crowd.RunsToTheEnd(1);
  }
  INFO(crowd.Snapshot());
  CHECK(crowd.state(other).goals_left.empty());
}
