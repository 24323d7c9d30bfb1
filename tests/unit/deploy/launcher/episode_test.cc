#include <catch2/catch.hpp>

#include "launcher/run_log.h"
#include "unit/deploy/launcher/sample_episode.h"

using namespace conav;
using namespace conav::launcher;

TEST_CASE("robots are numbered on over the worlds", "[launcher][episode]") {
  const Episode episode = MakeEpisode(2, 2);
  REQUIRE(episode.robots.size() == 4);
  CHECK(episode.robots[1].name == "r2");
  CHECK(episode.robots[1].world == "w1");
  CHECK(episode.robots[2].name == "r3");
  CHECK(episode.robots[2].world == "w2");
}

TEST_CASE("an episode without news is not finished", "[launcher][episode]") {
  CHECK_FALSE(MakeEpisode(1, 1).finished());
  CHECK_FALSE(MakeEpisode(1, 1).all_goals_reached());
}

TEST_CASE("a state that only tells the time is no news", "[launcher][episode]") {
  RobotRecord robot;
  RobotState state;
  CHECK(IsNews(robot, state));
  Record(robot, state);
  state.stamp = SimTime::FromSeconds(1.0);
  state.heading_rad = 1e-9;
  state.position = {0.0, 1e-9};
  CHECK_FALSE(IsNews(robot, state));
  ++state.pictures;
  CHECK(IsNews(robot, state));
}

TEST_CASE("the trajectory joins the paths of pictures with the path since the newest one",
          "[launcher][episode]") {
  const Episode episode = SampleEpisode();
  CHECK(WholeTrajectory(episode.robots[0]) == std::vector<Cell>{{3, 1}, {3, 2}, {3, 3}});
}

TEST_CASE("a picture that arrives before the state that counts it repeats no cells",
          "[launcher][episode]") {
  RobotRecord robot;
  RobotState state;
  state.cell = {1, 2};
  state.path = {{1, 1}, {1, 2}};
  Record(robot, state);
  Snapshot picture;
  picture.sequence_number = 1;
  picture.path = {{1, 1}, {1, 2}};
  Record(robot, picture);
  CHECK(WholeTrajectory(robot) == std::vector<Cell>{{1, 1}, {1, 2}});
}

TEST_CASE("a picture counts once", "[launcher][episode]") {
  RobotRecord robot;
  Snapshot picture;
  picture.sequence_number = 1;
  Record(robot, picture);
  Record(robot, picture);
  CHECK(robot.pictures.size() == 1);
}

TEST_CASE("guidance is counted by its newest revision, also when some were not heard",
          "[launcher][episode]") {
  RobotRecord robot;
  Guidance guidance;
  guidance.revision = 4;
  Record(robot, guidance);
  guidance.revision = 3;
  Record(robot, guidance);
  CHECK(robot.guidance_given == 4);
}

TEST_CASE("an older belief does not replace a newer one", "[launcher][episode]") {
  WorldRecord world;
  Belief belief;
  belief.revision = 2;
  Record(world, belief);
  belief.revision = 1;
  Record(world, belief);
  CHECK(world.edits() == 2);
}

TEST_CASE("robots that share goals reach them together", "[launcher][episode]") {
  Episode episode = MakeEpisode(2, 1);
  RobotState state;
  state.goals_total = 3;
  state.goals_reached = {{1, 1}, {1, 2}};
  Record(episode.robots[0], state);
  state.goals_reached = {{3, 3}};
  Record(episode.robots[1], state);
  CHECK(episode.finished());
  CHECK(episode.all_goals_reached());
  state.goals_reached = {};
  Record(episode.robots[1], state);
  CHECK_FALSE(episode.all_goals_reached());
}

TEST_CASE("a belief is a wall from one half on", "[launcher][episode]") {
  BeliefGrid belief(1, 2, 0.49F);
  belief[{0, 1}] = 0.5F;
  const OccupancyGrid map = BeliefAsMap(belief);
  CHECK(map[{0, 0}] == Occupancy::kFree);
  CHECK(map[{0, 1}] == Occupancy::kOccupied);
}
