#include "sim/motion_topics.h"

#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "common/grid/frames.h"
#include "integration/sim/sim_harness.h"

namespace conav::sim {
namespace {

using tf2_msgs::msg::TFMessage;

constexpr std::int64_t kMillisecond = 1'000'000;

/// All that comes on the topics of motion, of the first robot.
class MotionLog {
 public:
  MotionLog(bus::Participant& peer, bus::Demand demand)
      : clock_(peer, With(bus::kClock, demand), "",
               [this](auto&& message) { clock.push_back(ToDomain(message.clock()).value()); }),
        odometry_(peer, With(bus::kOdometry, demand), "r1",
                  [this](auto&& message) { odometry.push_back(std::move(message)); }),
        transforms_(peer, With(bus::kTransforms, demand), "r1",
                    [this](auto&& message) { transforms.push_back(std::move(message)); }),
        fleet_(peer, With(bus::kFleetTransforms, demand), "",
               [this](auto&& message) { fleet.push_back(std::move(message)); }) {}

  std::vector<SimTime> clock;
  std::vector<nav_msgs::msg::Odometry> odometry;
  std::vector<TFMessage> transforms;
  std::vector<TFMessage> fleet;

 private:
  template <class T>
  static bus::Topic<T> With(bus::Topic<T> topic, bus::Demand demand) {
    topic.qos.demand = demand;
    return topic;
  }
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock_;
  bus::Subscriber<nav_msgs::msg::Odometry> odometry_;
  bus::Subscriber<TFMessage> transforms_;
  bus::Subscriber<TFMessage> fleet_;
};

/// The stamps from after `begin` to `end`: each multiple of 20 ms and each control step.
std::vector<SimTime> FullRate(SimTime begin, SimTime end) {
  std::set<std::int64_t> stamps;
  for (std::int64_t at = begin.nanoseconds + 1; at <= end.nanoseconds; ++at) {
    const std::int64_t ms = at / kMillisecond;
    if (at % kMillisecond == 0 && (ms % 20 == 0 || ms % 250 == 0)) stamps.insert(at);
    if (at % kMillisecond != 0) at += kMillisecond - at % kMillisecond - 1;
  }
  std::vector<SimTime> times;
  for (const std::int64_t stamp : stamps) times.push_back({stamp});
  return times;
}

SimTime StampOf(const TFMessage& message) {
  return ToDomain(message.transforms().front().header().stamp()).value();
}

// Report row 10: "`ros2 topic hz /clock`, `/r1/odom`: 4.00 Hz at --speed 1".
TEST_CASE("a subscriber gets clock, odometry and transforms 50 times a second, from the physics",
          "[sim][row10]") {
  SimHarness sim(BlindConfig());
  const MotionLog log(sim.peer(), bus::Demand::kAll);
  REQUIRE(sim.Step() == CommandOutcome::kDone);
  const auto expected = FullRate({}, sim.robot().state().stamp);
  REQUIRE(expected.size() > 50);
  CHECK(log.clock == expected);
  REQUIRE(log.odometry.size() == expected.size());
  REQUIRE(log.transforms.size() == expected.size());
  REQUIRE(log.fleet.size() == expected.size());
  double way_m = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto& odometry = log.odometry[i];
    CHECK(ToDomain(odometry.header().stamp()).value() == expected[i]);
    CHECK(StampOf(log.transforms[i]) == expected[i]);
    CHECK(StampOf(log.fleet[i]) == expected[i]);
    const auto& moved = log.transforms[i].transforms().front().transform();
    CHECK(odometry.pose().pose().position().x() == moved.translation().x());
    CHECK(odometry.pose().pose().orientation() == moved.rotation());
    if (i == 0) continue;
    const auto& before = log.odometry[i - 1].pose().pose().position();
    const auto& at = odometry.pose().pose().position();
    const double step_m = std::hypot(at.x() - before.x(), at.y() - before.y());
    CHECK(step_m < 1.05 * kTopSpeedMps * 0.02);  // continuous
    way_m += step_m;
  }
  CHECK(way_m == Approx(2.0).margin(0.1));  // a cell, on the way and not in jumps of 0.25 s
}

TEST_CASE("who is content with the fewer changes nothing, nor does motion_hz: 4 send more",
          "[sim]") {
  const bool sparse = GENERATE(true, false);
  SimConfig config = BlindConfig();
  if (!sparse) config.motion_hz = 4.0;
  SimHarness sim(config);
  const MotionLog log(sim.peer(), sparse ? bus::Demand::kSparse : bus::Demand::kAll);
  REQUIRE(sim.Step() == CommandOutcome::kDone);
  const auto steps =
      static_cast<std::size_t>(sim.robot().state().stamp.nanoseconds / (250 * kMillisecond));
  CHECK(log.clock.size() == steps);
  CHECK(log.odometry.size() == steps);
  CHECK(log.transforms.size() == steps);
  CHECK(log.fleet.size() == steps);
}

TEST_CASE("the same commands make the same run, whether somebody listens or not", "[sim]") {
  std::vector<RobotState> states[2];
  std::vector<Snapshot> snapshots[2];
  for (const bool listens : {false, true}) {
    SimConfig config = BlindConfig(2);
    SimHarness sim(config);
    std::optional<MotionLog> log;
    if (listens) log.emplace(sim.peer(), bus::Demand::kAll);
    for (int round = 0; round < 6; ++round) {
      for (const auto& robot : sim.robots) {
        const Cell cell = robot->state().cell;
        robot->Send(robot->Move(cell + kNeighbourOffsets[static_cast<std::size_t>(round % 4)]));
      }
      sim.Settle();
      sim.Do(sim.robot().View(0.7 * round));
    }
    for (const auto& robot : sim.robots) {
      auto& all = states[listens ? 1 : 0];
      all.insert(all.end(), robot->states.begin(), robot->states.end());
    }
    snapshots[listens ? 1 : 0] = sim.robot().snapshots;
    if (listens) CHECK(log->clock.size() > 3 * sim.robot().states.size());
  }
  REQUIRE(states[0].size() > 40);
  CHECK(states[0] == states[1]);
  CHECK(snapshots[0] == snapshots[1]);
}

TEST_CASE("in real time poses are spread over the step, while its state is there at once",
          "[sim][row10]") {
  SimConfig config = BlindConfig();
  config.speed = 1.0;
  SimHarness sim(config);
  const MotionLog log(sim.peer(), bus::Demand::kAll);
  sim.robot().Send(sim.robot().View(2.0));
  CHECK(sim.Turn());
  CHECK(sim.robot().state().stamp == SimTime{250 * kMillisecond});
  CHECK(log.clock.empty());
  for (int ms = 10; ms <= 1000; ms += 10) {
    sim.clock.Advance(std::chrono::milliseconds(10));
    while (sim.Turn()) {
    }
    REQUIRE(log.clock == FullRate({}, {ms * kMillisecond}));
    REQUIRE(log.odometry.size() == log.clock.size());
  }
  // A machine that was busy for long: what was due comes, in order.
  sim.clock.Advance(std::chrono::milliseconds(600));
  while (sim.Turn()) {
  }
  CHECK(log.clock == FullRate({}, {1600 * kMillisecond}));
}

/// Parent of each frame.
std::map<std::string, std::string> Tree(const std::vector<TFMessage>& messages) {
  std::map<std::string, std::string> parents;
  for (const TFMessage& message : messages) {
    for (const auto& transform : message.transforms()) {
      const auto [known, is_new] =
          parents.emplace(transform.child_frame_id(), transform.header().frame_id());
      CHECK(known->second == transform.header().frame_id());  // one parent
    }
  }
  return parents;
}

/// "map odom base_link": from the root to `frame`.
std::string ChainTo(const std::map<std::string, std::string>& parents, std::string frame) {
  std::string chain = frame;
  for (auto found = parents.find(frame); found != parents.end(); found = parents.find(frame)) {
    frame = found->second;
    chain = frame + " " + chain;
  }
  return chain;
}

// Report rows 24, "no frames at all: only /r1/tf, /r2/tf are published", and 25, "one frame: map ->
// r1/base_link ... no camera_optical_frame ... no tf_static".
TEST_CASE("both conventions of TF have the whole chain, also for who comes late",
          "[sim][row24][row25]") {
  SimHarness sim(BlindConfig(2));
  const MotionLog log(sim.peer(), bus::Demand::kSparse);
  REQUIRE(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
  std::vector<TFMessage> plain = log.transforms;
  plain.push_back(sim.Latched(bus::kFixedTransforms, "r1"));
  CHECK(ChainTo(Tree(plain), "camera_optical_frame") ==
        "map odom base_link camera_link camera_optical_frame");
  std::vector<TFMessage> fleet = log.fleet;
  fleet.push_back(sim.Latched(bus::kFleetFixedTransforms, ""));
  const auto tree = Tree(fleet);
  CHECK(tree.size() == 8);
  for (const std::string robot : {"r1", "r2"}) {
    CHECK(
        ChainTo(tree, robot + "/camera_optical_frame") ==
        fmt::format("map {0}/odom {0}/base_link {0}/camera_link {0}/camera_optical_frame", robot));
  }
  CHECK(log.fleet.back().transforms().size() == 2);  // all robots in one message
  // Where the two chains end: base_link is where the state says.
  const auto& moved = log.transforms.back().transforms().front().transform();
  CHECK(moved.translation().x() == Approx(sim.robot().state().position.x_m));
  CHECK(moved.rotation() == ToQuaternion(sim.robot().state().heading_rad));
}

TEST_CASE("each convention of TF can be switched off", "[sim][row25]") {
  const bool robot = GENERATE(true, false);
  SimConfig config = BlindConfig();
  config.tf.robot = robot;
  config.tf.fleet = !robot;
  SimHarness sim(config);
  const MotionLog log(sim.peer(), bus::Demand::kSparse);
  REQUIRE(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
  CHECK(log.transforms.empty() != robot);
  CHECK(log.fleet.empty() == robot);
  CHECK_FALSE(log.odometry.empty());
  if (robot) {
    CHECK_NOTHROW(sim.Latched(bus::kFixedTransforms, "r1"));
    CHECK_THROWS(sim.Latched(bus::kFleetFixedTransforms, ""));
  } else {
    CHECK_THROWS(sim.Latched(bus::kFixedTransforms, "r1"));
    CHECK_NOTHROW(sim.Latched(bus::kFleetFixedTransforms, ""));
  }
}

// Report row 29: "robot_description ...: none".
TEST_CASE("each robot's URDF is latched", "[sim][row30]") {
  SimHarness sim(BlindConfig(2));
  const std::string urdf = sim.Latched(bus::kRobotDescription, "r2").data();
  CHECK_THAT(urdf, Catch::Contains("<robot name=\"r2\">"));
  CHECK_THAT(urdf, Catch::Contains(std::string("<link name=\"").append(kOpticalFrame)));
}

}  // namespace
}  // namespace conav::sim
