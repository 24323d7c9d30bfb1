#include "operator/recording/recorder_service.h"

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/bus/topics.h"
#include "operator/recording/mcap_file.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"

namespace conav::recorder {
namespace {

using namespace std::chrono_literals;

TEST_CASE("A topic's QoS is what rosbag2 calls it, and nothing ends", "[operator][recorder]") {
  struct Row {
    const char* name;
    bus::Qos qos;
    int history, depth, reliability, durability;
  };
  for (const Row& row : std::vector<Row>{{"latched", bus::kLatchedQos, 1, 1, 1, 1},
                                         {"sensor", bus::kSensorQos, 1, 5, 2, 2},
                                         {"keep all", bus::kRequestQos, 2, 0, 1, 2}}) {
    CAPTURE(row.name);
    const YAML::Node list = YAML::Load(OfferedQosText(row.qos));
    REQUIRE(list.size() == 1);
    CHECK(list[0]["history"].as<int>() == row.history);
    CHECK(list[0]["depth"].as<int>() == row.depth);
    CHECK(list[0]["reliability"].as<int>() == row.reliability);
    CHECK(list[0]["durability"].as<int>() == row.durability);
    for (const char* duration : {"deadline", "lifespan", "liveliness_lease_duration"}) {
      CHECK(list[0][duration]["sec"].as<std::int64_t>() == 9223372036);
      CHECK(list[0][duration]["nsec"].as<std::int64_t>() == 854775807);
    }
  }
}

TEST_CASE("The writer is woken when much waits, what it cannot take is dropped and counted",
          "[operator][recorder]") {
  int woken = 0;
  Arrivals arrivals(
      40, [&] { ++woken; }, [] { return std::uint64_t{5}; });
  arrivals.Add(1, 0, bag::Bytes(10));
  CHECK(woken == 0);
  arrivals.Add(1, 0, bag::Bytes(1));
  CHECK(woken == 1);
  for (int i = 0; i < 3; ++i) arrivals.Add(1, 0, bag::Bytes(10));
  CHECK(arrivals.dropped() == 1);
  CHECK(arrivals.Take().size() == 4);
  arrivals.Add(1, 0, bag::Bytes(40));
  CHECK(arrivals.Take().size() == 1);
  CHECK(arrivals.dropped() == 1);
}

TEST_CASE("Of a latched topic the newest message of each of the newest writers is kept",
          "[operator][recorder]") {
  LatchedMessages latched;
  const auto keep = [&](std::uint8_t writer, std::uint8_t content) {
    latched.Keep({.channel = 3, .data = {content}, .writer = {writer}});
  };
  const auto contents = [&] {
    std::vector<int> found;
    for (const Arrival& arrival : latched.newest().at(3)) found.push_back(arrival.data[0]);
    return found;
  };
  keep(1, 10);
  keep(2, 20);
  keep(1, 11);
  CHECK(contents() == std::vector{20, 11});
  for (std::uint8_t writer = 3; writer < 3 + LatchedMessages::kWriters; ++writer) keep(writer, 30);
  CHECK(contents() == std::vector<int>(LatchedMessages::kWriters, 30));
}

struct ListenersFixture {
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant recorder{"recorder", bus};
  bus::Participant robot{"robot", bus};
  Arrivals arrivals{1 << 20, [] {}, [] { return std::uint64_t{5}; }};
  std::vector<TopicFacts> topics;  // by channel

  TopicListeners Listen(const RecorderConfig& config) {
    const auto add = [this](const TopicFacts& topic) {
      topics.push_back(topic);
      return static_cast<std::uint16_t>(topics.size() - 1);
    };
    return {recorder, config, add, arrivals};
  }
  bool Has(const std::string& name) const {
    return std::ranges::find(topics, name, &TopicFacts::name) != topics.end();
  }
};

TEST_CASE("Every topic of robots, worlds and system is listened to but streams and repeats",
          "[operator][recorder]") {
  ListenersFixture fixture;
  const auto listeners = fixture.Listen({.robots = {"w1/r1", "w1/r2", "w2/r3"}});
  std::size_t expected = 0;
  const auto add = [&](std::size_t entities) {
    return [&expected, entities](const auto& topic) {
      const bool is_left_out =
          topic.pattern == bus::kCameraImage.pattern ||
          std::ranges::find(bus::kLinkPatterns, topic.pattern) != bus::kLinkPatterns.end();
      expected += is_left_out ? 0 : entities;
    };
  };
  bus::ForEachRobotTopic(add(3));
  bus::ForEachWorldTopic(add(2));
  bus::ForEachSystemTopic(add(1));
  CHECK(listeners.topics() == expected);
  CHECK(fixture.topics.size() == expected);
  for (const char* name : {"/r3/state", "/w2/truth", "/clock"}) CHECK(fixture.Has(name));
  CHECK_FALSE(fixture.Has("/r1/camera/image/compressed"));
}

TEST_CASE("Without robots the system's topics are recorded, as of a form", "[operator][recorder]") {
  ListenersFixture fixture;
  const auto listeners = fixture.Listen({.robots = {}});
  std::size_t expected = 0;
  bus::ForEachSystemTopic([&](const auto&) { ++expected; });
  CHECK(listeners.topics() == expected);
  CHECK(fixture.Has("/conav/study/mark"));
  bus::Publisher<conav_msgs::msg::StudyMark> marks(fixture.robot, bus::kStudyMark);
  REQUIRE(marks.Publish({}));
  CHECK(fixture.arrivals.Take().size() == 1);
}

TEST_CASE("Every topic's type has a definition", "[operator][recorder]") {
  ListenersFixture fixture;
  const auto listeners = fixture.Listen({.streams = true});
  CHECK(fixture.Has("/r1/camera/image/compressed"));
  for (const TopicFacts& topic : fixture.topics) {
    CAPTURE(topic.name, topic.type);
    CHECK(bag::ConavSchemas().contains(topic.type));
    CHECK_FALSE(topic.offered_qos.empty());
  }
}

TEST_CASE("Topics are left out by name or for all, what is not there is refused",
          "[operator][recorder]") {
  ListenersFixture fixture;
  const auto listeners = fixture.Listen(
      {.robots = {"w1/r1", "w1/r2"}, .exclude = {"/{}/odom", "/r1/tf", "/conav/planner/lease"}});
  for (const char* name : {"/r1/odom", "/r2/odom", "/r1/tf", "/conav/planner/lease"}) {
    CHECK_FALSE(fixture.Has(name));
  }
  CHECK(fixture.Has("/r2/tf"));
  CHECK_THROWS_WITH(fixture.Listen({.exclude = {"/r7/odom"}}),
                    Catch::StartsWith("recorder.exclude: '/r7/odom'"));
  CHECK_THROWS_AS(fixture.Listen({.robots = {"r1"}}), StartupError);
}

TEST_CASE("A message arrives as it was serialised, with the stamp of its header or its arrival",
          "[operator][recorder]") {
  ListenersFixture fixture;
  const auto listeners = fixture.Listen({});
  bus::Publisher states(fixture.robot, bus::kRobotState, "r1");
  conav_msgs::msg::RobotState state;
  state.header().stamp().sec(3);
  state.header().stamp().nanosec(4);
  state.robot("r1");
  state.moves(9);
  REQUIRE(states.Publish(state));
  const conav_msgs::msg::RobotState sent = state;
  state.header().stamp().sec(-1);
  REQUIRE(states.Publish(state));
  bus::Publisher clock(fixture.robot, bus::kClock);
  REQUIRE(clock.Publish({}));  // has no header
  const auto arrivals = fixture.arrivals.Take();
  REQUIRE(arrivals.size() == 3);
  CHECK(fixture.topics.at(arrivals[0].channel).name == "/r1/state");
  CHECK(fixture.topics.at(arrivals[0].channel).type == "conav_msgs/msg/RobotState");
  CHECK(arrivals[0].log_time == 5);
  CHECK(arrivals[0].publish_time == 3'000'000'004);
  CHECK(arrivals[1].publish_time == 5);
  CHECK(arrivals[2].publish_time == 5);
  CHECK(fixture.topics.at(arrivals[2].channel).name == "/clock");
  CHECK(fixture.arrivals.Take().empty());
  conav_msgs::msg::RobotState read;
  REQUIRE(bus::TypeSupportOf<conav_msgs::msg::RobotState>().deserialize(arrivals[0].data, &read));
  CHECK(read == sent);
}

TEST_CASE("Of clock and poses that come often, one in a quarter of a second is recorded",
          "[operator][recorder]") {
  const bool full_rate = GENERATE(false, true);
  ListenersFixture fixture;
  const auto listeners = fixture.Listen({.robots = {"w1/r1", "w2/r2"}, .full_rate = full_rate});
  bus::Publisher clock(fixture.robot, bus::kClock);
  bus::Publisher odometry(fixture.robot, bus::kOdometry, "r1");
  bus::Publisher transforms(fixture.robot, bus::kFleetTransforms);
  CHECK(clock.demanding_subscribers() == (full_rate ? 1 : 0));
  CHECK(odometry.demanding_subscribers() == (full_rate ? 1 : 0));
  const auto publish = [&](std::uint32_t ms) {
    rosgraph_msgs::msg::Clock time;
    time.clock().nanosec(ms * 1'000'000);
    REQUIRE(clock.Publish(time));
    nav_msgs::msg::Odometry pose;
    pose.header().stamp(time.clock());
    REQUIRE(odometry.Publish(pose));
    for (const char* frame : {"r1/base_link", "r2/base_link"}) {  // two simulators
      tf2_msgs::msg::TFMessage message;
      message.transforms().resize(1);
      message.transforms()[0].header().stamp(time.clock());
      message.transforms()[0].child_frame_id(frame);
      REQUIRE(transforms.Publish(message));
    }
  };
  for (std::uint32_t ms = 0; ms <= 500; ms += 10) publish(ms);
  publish(20);  // a simulator that starts again
  std::map<std::string, int> count;
  for (const Arrival& arrival : fixture.arrivals.Take())
    ++count[fixture.topics[arrival.channel].name];
  const int expected = full_rate ? 52 : 4;  // 0, 250, 500, and 20 again
  CHECK(count["/clock"] == expected);
  CHECK(count["/r1/odom"] == expected);
  CHECK(count["/tf"] == 2 * expected);
}

struct ServiceFixture {
  explicit ServiceFixture(RecorderConfig config = {}) {
    config.file = file.string();
    service.emplace(recorder, config, clock);
  }

  void Publish(std::uint64_t cell_moves) {
    conav_msgs::msg::RobotState state;
    state.robot("r1");
    state.moves(cell_moves);
    REQUIRE(states.Publish(state));
  }
  /// How many states are in the file now.
  std::uint64_t Recorded() const {
    auto reader = bag::McapReader::Open(file);
    REQUIRE(reader);
    for (const bag::RecordedTopic& recorded : reader->topics()) {
      if (recorded.channel.topic == "/r1/state") return recorded.message_count;
    }
    return 0;
  }
  /// What the service said of itself last.
  diagnostic_msgs::msg::DiagnosticStatus Health() {
    clock.Advance(1s);
    service->Step();
    const auto said = diagnostics.Take();
    REQUIRE_FALSE(said.empty());
    return said.back().status().at(0);
  }

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "recording.mcap";
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  bus::Participant recorder{"recorder", bus};
  bus::Participant robot{"robot", bus};
  bus::Publisher<conav_msgs::msg::RobotState> states{robot, bus::kRobotState, "r1"};
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> diagnostics{robot, bus::kDiagnostics};
  std::optional<RecorderService> service;
};

TEST_CASE("Messages are in the file within a second", "[operator][recorder]") {
  ServiceFixture fixture;
  fixture.Publish(1);
  fixture.service->Step();
  CHECK(fixture.Recorded() == 0);
  fixture.clock.Advance(900ms);
  fixture.service->Step();
  CHECK(fixture.Recorded() == 1);
  fixture.Publish(2);
  fixture.clock.Advance(10s);  // the age of a chunk is that of its first message
  fixture.service->Step();
  CHECK(fixture.Recorded() == 1);
}

TEST_CASE("A finished recording has all messages, definitions and the run's facts",
          "[operator][recorder]") {
  RecorderConfig config;
  config.facts = {{"seed", "7"}};
  ServiceFixture fixture(config);
  fixture.Publish(1);
  fixture.Publish(2);
  fixture.service->Finish();
  auto reader = bag::McapReader::Open(fixture.file);
  REQUIRE(reader);
  CHECK(reader->cut_off().empty());
  CHECK(fixture.Recorded() == 2);
  REQUIRE(reader->metadata().size() == 1);
  const bag::Metadata& metadata = reader->metadata()[0];
  CHECK(metadata.name == "conav");
  CHECK(metadata.values.at("seed") == "7");
  CHECK(metadata.values.at("robots") == "w1/r1");
  CHECK_FALSE(metadata.values.at("conav_version").empty());
  const auto state = std::find_if(reader->topics().begin(), reader->topics().end(),
                                  [](const auto& t) { return t.channel.topic == "/r1/state"; });
  REQUIRE(state != reader->topics().end());
  CHECK(state->schema.name == "conav_msgs/msg/RobotState");
  CHECK(state->schema.encoding == "ros2msg");
  CHECK(state->channel.message_encoding == "cdr");
  CHECK(state->channel.metadata.contains("offered_qos_profiles"));
}

TEST_CASE("A full disk is reported on /diagnostics, and recording goes on when there is room",
          "[operator][recorder]") {
  ServiceFixture fixture;
  fixture.Publish(1);
  fixture.service->Step();
  CHECK(fixture.Health().level() == 0);
  REQUIRE(fixture.Recorded() == 1);
  {
    const test::FullDisk disk(std::filesystem::file_size(fixture.file) + 20);
    fixture.Publish(2);
    fixture.service->Step();
    fixture.Health();
    const auto health = fixture.Health();
    CHECK(health.level() == 2);
    CHECK_THAT(health.message(), Catch::Contains("recording.mcap: "));
  }
  fixture.Publish(3);
  fixture.Health();
  const auto health = fixture.Health();
  CHECK(health.level() == 1);
  fixture.service->Finish();
  CHECK(fixture.Recorded() == 2);
}

TEST_CASE("A file that cannot be made stops the start", "[operator][recorder]") {
  ServiceFixture fixture;
  RecorderConfig config;
  config.file = (fixture.folder / "none/recording.mcap").string();
  CHECK_THROWS_WITH(RecorderService(fixture.recorder, config, fixture.clock),
                    Catch::StartsWith("recorder.file: " + config.file));
}

// The faults report's section 2 (a): "restart with the same file is refused ("File exists", exit 1): no
// supervisor can restart it".
TEST_CASE("A recorder that starts again goes on in a new file and leaves the old one as it is",
          "[operator][recorder]") {
  ServiceFixture fixture;
  fixture.Publish(1);
  fixture.service->Finish();
  RecorderConfig config;
  config.file = fixture.file.string();
  for (const char* name : {"recording-2.mcap", "recording-3.mcap"}) {
    fixture.service.emplace(fixture.recorder, config, fixture.clock);
    fixture.Publish(2);
    fixture.service->Finish();
    CHECK(bag::McapReader::Open(fixture.folder / name));
  }
  // Read as one: the latched state comes again to each recorder.
  CHECK(bag::McapReader::Open(fixture.file).value().files() == 3);
  CHECK(fixture.Recorded() >= 3);
}

// A soak of 16 robots, 13 minutes: each file began with every robot's last hundred pictures, until these alone
// filled it.
TEST_CASE("A full file is followed by another that can be read by itself, and old ones are removed",
          "[operator][recorder]") {
  RecorderConfig config;
  if (GENERATE(true, false)) {
    config.max_file_mib = 0.002;  // above the head of a file, below one with messages
  } else {
    config.max_index_mib = 0.00005;  // one chunk
  }
  config.keep_files = 2;
  ServiceFixture fixture(config);
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map(fixture.robot, bus::kRobotMap, "r1");
  bus::Publisher<conav_msgs::msg::Snapshot> pictures(fixture.robot, bus::kSnapshot, "r1");
  REQUIRE(map.Publish({}));
  REQUIRE(pictures.Publish({}));
  for (std::uint64_t state = 1; state <= 3; ++state) {
    fixture.Publish(state);
    fixture.service->Step();
    fixture.clock.Advance(1s);
    fixture.service->Step();
    fixture.service->Step();
  }
  fixture.service->Finish();
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(fixture.folder.path())) {
    names.push_back(entry.path().filename().string());
    auto reader = bag::McapReader::Open(entry.path());
    REQUIRE(reader);
    CHECK(reader->cut_off().empty());
    const auto count = [&](std::string_view name) {
      const auto found = std::ranges::find(reader->topics(), name, [](const auto& topic) {
        return std::string_view(topic.channel.topic);
      });
      REQUIRE(found != reader->topics().end());
      return found->message_count;
    };
    CHECK(count("/r1/map") == static_cast<std::uint64_t>(reader->files()));  // in each
    CHECK(count("/r1/snapshot") == 0);  // in the first, which was removed
  }
  CHECK(names.size() == 2);
  CHECK_FALSE(std::filesystem::exists(fixture.file));
}

}  // namespace
}  // namespace conav::recorder
