#include "operator/recording/recorder_service.h"

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/bus/subscriber.h"
#include "operator/recording/mcap_reader.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"

namespace conav::recorder {
namespace {

using namespace std::chrono_literals;

struct Desk {
  explicit Desk(RecorderConfig config = {}) {
    config.file = file.string();
    service.emplace(recorder, config, clock);
  }

  void Publish(std::uint64_t cell_moves) {
    conav_msgs::msg::RobotState state;
    state.robot("r1");
    state.cell_moves(cell_moves);
    REQUIRE(states.Publish(state));
  }
  /// How many states are in the file now.
  std::uint64_t Recorded() const { return CountOf(file, "/r1/state"); }
  static std::uint64_t CountOf(const std::filesystem::path& file, const std::string& topic) {
    auto reader = bag::McapReader::Open(file);
    REQUIRE(reader);
    for (const bag::RecordedTopic& recorded : reader->topics()) {
      if (recorded.channel.topic == topic) return recorded.message_count;
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

TEST_CASE("What was said is in the file within a second", "[operator][recorder]") {
  Desk desk;
  desk.Publish(1);
  desk.service->Step();
  CHECK(desk.Recorded() == 0);
  desk.clock.Advance(900ms);
  desk.service->Step();
  CHECK(desk.Recorded() == 1);
  desk.Publish(2);
  desk.clock.Advance(10s);  // the age of a chunk is that of its first message
  desk.service->Step();
  CHECK(desk.Recorded() == 1);
}

TEST_CASE("A finished recording has all messages, definitions and the run's facts",
          "[operator][recorder]") {
  RecorderConfig config;
  config.facts = {{"seed", "7"}};
  Desk desk(config);
  desk.Publish(1);
  desk.Publish(2);
  desk.service->Finish();
  auto reader = bag::McapReader::Open(desk.file);
  REQUIRE(reader);
  CHECK(reader->cut_off().empty());
  CHECK(desk.Recorded() == 2);
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

TEST_CASE("Run ends when it is asked to, with a whole file", "[operator][recorder]") {
  test::TemporaryFolder folder;
  const auto file = folder / "recording.mcap";
  RecorderConfig config;
  config.file = file.string();
  auto bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("recorder", bus);
  const SteadyClock clock;
  RecorderService service(participant, config, clock);
  bus::Publisher<conav_msgs::msg::RobotState> states(participant, bus::kRobotState, "r1");
  REQUIRE(states.Publish({}));
  StopToken stop;
  stop.RequestStop();
  service.Run(stop);
  CHECK(Desk::CountOf(file, "/r1/state") == 1);
  CHECK(bag::McapReader::Open(file)->cut_off().empty());
}

TEST_CASE("A full disk is told on /diagnostics, and recording goes on when there is room",
          "[operator][recorder]") {
  Desk desk;
  desk.Publish(1);
  desk.service->Step();
  CHECK(desk.Health().level() == 0);
  REQUIRE(desk.Recorded() == 1);
  {
    const test::FullDisk disk(std::filesystem::file_size(desk.file) + 20);
    desk.Publish(2);
    desk.service->Step();
    desk.Health();
    const auto health = desk.Health();
    CHECK(health.level() == 2);
    CHECK_THAT(health.message(), Catch::Contains("recording.mcap: File too large"));
  }
  desk.Publish(3);
  desk.Health();
  const auto health = desk.Health();
  CHECK(health.level() == 1);
  CHECK(health.message() == "recording");
  desk.service->Finish();
  CHECK(desk.Recorded() == 2);
}

TEST_CASE("A file that cannot be made, or exists, stops the start", "[operator][recorder]") {
  test::TemporaryFolder folder;
  auto bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("recorder", bus);
  const FakeClock clock;
  RecorderConfig config;
  config.file = (folder / "none/recording.mcap").string();
  CHECK_THROWS_WITH(RecorderService(participant, config, clock),
                    Catch::Contains("recorder.file: ") && Catch::Contains("No such file"));
  config.file = (folder / "recording.mcap").string();
  { const RecorderService first(participant, config, clock); }
  CHECK_THROWS_WITH(RecorderService(participant, config, clock), Catch::Contains("File exists"));
}

}  // namespace
}  // namespace conav::recorder
