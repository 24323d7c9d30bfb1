#include "launcher/run_log.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "unit/deploy/launcher/sample_episode.h"

namespace conav::launcher {
namespace {

TEST_CASE("robots are numbered on over the worlds", "[launcher]") {
  const Episode episode = MakeEpisode(2, 2);
  std::vector<std::pair<std::string, std::string>> robots;
  for (const RobotRecord& robot : episode.robots) robots.emplace_back(robot.name, robot.world);
  CHECK(robots == decltype(robots){{"r1", "w1"}, {"r2", "w1"}, {"r3", "w2"}, {"r4", "w2"}});
  CHECK_FALSE(episode.finished());
  CHECK_FALSE(episode.all_goals_reached());
}

TEST_CASE("a state with only a newer time is no news", "[launcher]") {
  RobotRecord robot;
  RobotState state;
  CHECK(IsNewer(robot, state));
  Record(robot, state);
  state.stamp = SimTime::FromSeconds(1.0);
  state.heading_rad = 1e-9;
  state.position = {0.0, 1e-9};
  CHECK_FALSE(IsNewer(robot, state));
  ++state.images;
  CHECK(IsNewer(robot, state));
}

TEST_CASE("the trajectory joins the paths of pictures with the path since the newest one",
          "[launcher]") {
  CHECK(WholeTrajectory(SampleEpisode().robots[0]) == std::vector<Cell>{{3, 1}, {3, 2}, {3, 3}});
  // A picture that arrives before the state that counts it, or twice, repeats no cells.
  RobotRecord robot;
  const RobotState state{.cell = {1, 2}, .path = {{1, 1}, {1, 2}}};
  Record(robot, state);
  const Snapshot snapshot{.sequence_number = 1, .path = state.path};
  Record(robot, snapshot);
  Record(robot, snapshot);
  CHECK(robot.snapshots.size() == 1);
  CHECK(WholeTrajectory(robot) == state.path);
}

TEST_CASE("guidance and edits are counted by the newest revision, not by messages", "[launcher]") {
  RobotRecord robot;
  Guidance guidance;
  WorldRecord world;
  Belief belief;
  for (const std::uint64_t revision : {4, 3}) {
    guidance.revision = belief.revision = revision;
    Record(robot, guidance);
    Record(world, belief);
  }
  CHECK(robot.guidance_given == 4);
  CHECK(world.edits() == 4);
}

TEST_CASE("who did what is counted by name, people at the console apart from programs",
          "[launcher]") {
  Episode episode = SampleEpisode();
  const auto record = [&](const char* client, RequestKind kind, bool accepted = true) {
    Record(episode, {.kind = kind, .accepted = accepted, .client = client, .cells = 3});
  };
  record("synthetic-operator-01a2176bd43c-4c91e7b4", RequestKind::kStop);
  CHECK(Measure(episode).operators() == "nobody");
  record("Ben/2c81", RequestKind::kEdit);
  record("Ben/99ff", RequestKind::kEdit);
  record("Ben/99ff", RequestKind::kGuide);
  record("Ben/99ff", RequestKind::kAnswer, false);
  const EpisodeMetrics metrics = Measure(episode);
  CHECK(metrics.operators() == "person");
  REQUIRE(metrics.clients.size() == 2);
  const ClientRecord& ben = metrics.clients.at("Ben");
  CHECK(ben.at_page);
  CHECK((ben.edits == 2 && ben.cells == 6 && ben.paths == 1 && ben.refused == 1));
  CHECK(ToJson(metrics)["clients"][0]["name"] == "Ben");
  record("synthetic-operator-01a2176bd43c-4c91e7b4", RequestKind::kGuide);
  CHECK(Measure(episode).operators() == "person and simulated");
}

TEST_CASE("robots that share goals reach them together", "[launcher]") {
  Episode episode = MakeEpisode(2, 1);
  RobotState state{.goals_reached = {{1, 1}, {1, 2}}, .goals_total = 3};
  Record(episode.robots[0], state);
  state.goals_reached = {{3, 3}};
  Record(episode.robots[1], state);
  CHECK(episode.finished());
  CHECK(episode.all_goals_reached());
  state.goals_reached = {};
  Record(episode.robots[1], state);
  CHECK_FALSE(episode.all_goals_reached());
}

TEST_CASE("percentiles are nearest ranks, a belief is a wall from one half on", "[launcher]") {
  const std::vector<double> values{5, 1, 4, 2, 3};
  CHECK(Percentile(values, 0.5) == 3);
  CHECK(Percentile(values, 0.99) == 5);
  CHECK(Percentile(values, 0.0) == 1);
  CHECK(Percentile({}, 0.5) == 0);
  BeliefGrid belief(1, 2, 0.49F);
  belief[{0, 1}] = 0.5F;
  CHECK(BeliefAsMap(belief).values()[0] == Occupancy::kFree);
  CHECK(BeliefAsMap(belief).values()[1] == Occupancy::kOccupied);
}

TEST_CASE("a robot's time ends with its last goal", "[launcher]") {
  Episode episode = MakeEpisode(1, 1);
  RobotState state;
  state.goals_left = {{1, 1}};
  state.stamp = SimTime::FromSeconds(3.0);
  Record(episode.robots[0], state);
  CHECK(MeasureRobot(episode.robots[0]).time_s == 3.0);
  state.goals_left.clear();
  state.stamp = SimTime::FromSeconds(5.25);
  Record(episode.robots[0], state);
  state.stamp = SimTime::FromSeconds(9.0);
  Record(episode.robots[0], state);
  CHECK(MeasureRobot(episode.robots[0]).time_s == 5.25);
}

TEST_CASE("goals that have to be found count, not those that were given", "[launcher]") {
  Episode episode = MakeEpisode(1, 1);
  RobotRecord& robot = episode.robots[0];
  robot.hidden_goals = {{1, 1}, {2, 2}};
  RobotState state;  // nothing was found yet
  Record(robot, state);
  CHECK(robot.goals == robot.hidden_goals);
  CHECK_FALSE(episode.finished());
  state.goals_reached = {{1, 1}, {3, 3}};  // the second is none
  Record(robot, state);
  CHECK_FALSE(episode.finished());
  CHECK(MeasureRobot(robot).goals_reached == 1);
  CHECK(MeasureRobot(robot).goals_total == 2);
  state.goals_reached.push_back({2, 2});
  Record(robot, state);
  CHECK(episode.all_goals_reached());
}

TEST_CASE("an episode is measured from what its robots said", "[launcher]") {
  Episode episode = SampleEpisode();
  for (const double duration_ms : {4.0, 6.0, 50.0}) {
    SearchReport report;
    report.decision = episode.robots[0].decisions + 1;
    report.duration_ms = duration_ms;
    Record(episode.robots[0], report);
  }
  Belief belief;
  belief.revision = 1;
  belief.wall_probability = BeliefGrid(5, 5, 0.0F);
  for (std::size_t i = 0; i < 25; ++i) {
    if (episode.worlds[0].initial_map->values()[i] == Occupancy::kOccupied) {
      belief.wall_probability.values()[i] = 1.0F;
    }
  }
  belief.wall_probability[{2, 2}] = 0.0F;
  Record(episode.worlds[0], belief);

  const EpisodeMetrics metrics = Measure(episode);
  CHECK(metrics.all_goals_reached);
  CHECK(metrics.before.mapping == 0.0);
  CHECK(metrics.after.mapping == Approx(0.5));
  CHECK(metrics.before.cell == Approx(7.0 / 9));
  CHECK(metrics.after.cell == Approx(8.0 / 9));
  REQUIRE(metrics.robots.size() == 1);
  CHECK(metrics.robots[0].decisions == 3);
  CHECK(metrics.robots[0].decision_ms_median == 6.0);
  CHECK(metrics.robots[0].decision_ms_p95 == 50.0);
  CHECK(metrics.robots[0].decision_ms_p99 == 50.0);
}

TEST_CASE("the shortest tour takes the goals in the best order, around walls", "[launcher]") {
  OccupancyGrid map(3, 7, Occupancy::kFree);
  CHECK(ShortestTour(map, {1, 3}, {}) == 0.0);
  // To the nearer end first and then to the other one.
  CHECK(ShortestTour(map, {1, 2}, {{1, 6}, {1, 4}, {1, 0}}) == 8.0);
  map[{1, 5}] = map[{0, 5}] = Occupancy::kOccupied;
  CHECK(ShortestTour(map, {1, 4}, {{1, 6}}) == 4.0);
  CHECK(ShortestTour(map, {1, 4}, {{1, 6}}, 0.2) == 4.0);  // no corner is cut
  map[{2, 5}] = Occupancy::kOccupied;
  CHECK(ShortestTour(map, {1, 4}, {{1, 6}}, 0.2) == 0.0);
}

TEST_CASE("the shortest tour of a robot that drives anywhere is straight, and as wide as it is",
          "[launcher]") {
  const OccupancyGrid open(21, 21, Occupancy::kFree);
  CHECK(ShortestTour(open, {10, 2}, {{10, 18}}, 0.2) == Approx(16.0));
  // A direction that none of the legs has costs less than one percent.
  const double slanted = std::hypot(7.0, 16.0);
  const double found = ShortestTour(open, {10, 2}, {{17, 18}}, 0.2);
  CHECK(found >= slanted - 1e-9);
  CHECK(found <= 1.01 * slanted);

  OccupancyGrid walled = open;  // a wall with a gap of five cells at the southern end
  for (int row = 0; row < 16; ++row) walled[{row, 10}] = Occupancy::kOccupied;
  const double around = 2.0 * std::hypot(8.0, 6.0);
  CHECK(ShortestTour(walled, {10, 2}, {{10, 18}}, 0.2) == Approx(around).epsilon(0.03));
  // A wide robot goes farther south, one wider than the gap does not come through.
  const double of_wide = ShortestTour(walled, {10, 2}, {{10, 18}}, 2.0);
  CHECK(of_wide > around + 1.0);
  CHECK(of_wide < 2.0 * around);
  CHECK(ShortestTour(walled, {10, 2}, {{10, 18}}, 3.0) == 0.0);
}

TEST_CASE("what robots drove is compared with their shortest tours once all goals are reached",
          "[launcher]") {
  Episode episode = SampleEpisode();
  episode.worlds[0].cell_size_m = 0.5;
  episode.robots[0].state->distance_m = 1.5;
  CHECK(Measure(episode).robots[0].optimal_distance_m == 1.0);
  CHECK(Measure(episode).path_over_optimum() == 1.5);
  // In open terrain a goal is reached from 2 m away.
  episode.open = true;
  episode.robot_radius_m = 0.2;
  episode.worlds[0].cell_size_m = 2.0;
  CHECK(Measure(episode).robots[0].optimal_distance_m == 2.0);
  episode.shared_goals = true;
  CHECK(Measure(episode).path_over_optimum() == 0.0);
  episode.shared_goals = false;
  episode.robots[0].state->goals_total = 2;
  CHECK(Measure(episode).path_over_optimum() == 0.0);
}

TEST_CASE("the JSON object has every key that it promises", "[launcher]") {
  const auto json = ToJson(Measure(SampleEpisode()));
  for (const char* key : {"all_goals_reached", "mapping_accuracy_before", "mapping_accuracy_after",
                          "cell_accuracy_before", "cell_accuracy_after", "path_over_optimum"}) {
    CHECK(json.contains(key));
  }
  const auto& robot = json.at("robots").at(0);
  for (const char* key :
       {"name", "world", "goals_reached", "goals_total", "cell_moves", "low_level_steps",
        "distance_m", "optimal_distance_m", "pictures", "picture_bytes", "guidance", "decisions",
        "decision_ms_median", "decision_ms_p95", "decision_ms_p99", "perception_model"}) {
    CHECK(robot.contains(key));
  }
  CHECK(robot.at("picture_bytes") == 12345);
  CHECK(robot.at("low_level_steps") == 17);
}

}  // namespace
}  // namespace conav::launcher
