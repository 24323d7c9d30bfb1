#include "planner/decision/method.h"

#include <catch2/catch.hpp>

#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;

TEST_CASE("a robot seeks the goals that it knows, else the end of the path, else what is unseen",
          "[planner]") {
  Situation situation;
  situation.map.cells = MapFrom({"#######", "#   ??#", "#######"});
  situation.state.cell = {1, 1};
  situation.state.goals_total = 2;
  situation.state.goals_left = {{1, 2}, {1, 5}};
  const auto after = [&](GoalKnowledge knowledge) {
    Situation limited = situation;
    LimitKnowledge(limited, knowledge);
    return limited;
  };
  const auto seek = [&](GoalKnowledge knowledge) { return after(knowledge).state.goals_left; };
  CHECK(seek(GoalKnowledge::kAll) == std::vector<Cell>{{1, 2}, {1, 5}});
  CHECK(seek(GoalKnowledge::kTold) == std::vector<Cell>{{1, 2}, {1, 5}});
  CHECK(seek(GoalKnowledge::kSeen) == std::vector<Cell>{{1, 2}});
  situation.state.goals_left = {{1, 5}};
  CHECK(seek(GoalKnowledge::kSeen) == std::vector<Cell>{{1, 4}});  // the nearest unseen cell
  CHECK(after(GoalKnowledge::kSeen).lacks_way);
  CHECK_FALSE(after(GoalKnowledge::kTold).lacks_way);  // the operator knows of none either
  CHECK(after(GoalKnowledge::kTold).goals_to_find == 1);
  situation.guidance = Guidance{.path = {{1, 1}, {1, 2}, {1, 3}, {1, 4}, {1, 5}}};
  situation.guided_before = true;
  CHECK(seek(GoalKnowledge::kSeen) == std::vector<Cell>{{1, 5}});  // the path leads over it
  CHECK(after(GoalKnowledge::kSeen).guidance.has_value());
  CHECK_FALSE(after(GoalKnowledge::kSeen).lacks_way);
  situation.state.goals_left = {};
  CHECK(seek(GoalKnowledge::kTold) == std::vector<Cell>{{1, 5}});  // the end of the path
  situation.map.cells[{1, 3}] = Occupancy::kOccupied;
  CHECK(seek(GoalKnowledge::kTold).empty());  // nothing unseen can be reached
  situation.map.cells[{1, 5}] = Occupancy::kFree;
  CHECK_FALSE(after(GoalKnowledge::kTold).guidance.has_value());  // used up
  CHECK_FALSE(after(GoalKnowledge::kTold).guided_before);
  CHECK(after(GoalKnowledge::kAll).guidance.has_value());
  situation.state.goals_reached = {{1, 2}, {1, 3}};
  CHECK(seek(GoalKnowledge::kTold).empty());
}
