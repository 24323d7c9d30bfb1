#include <limits>

#include "common/msg/convert.h"
#include "operator/replay/timeline.h"
#include "support/temporary_folder.h"
#include "unit/common/msg/samples.h"
#include "unit/operator/replay/recorded_file.h"

namespace conav::operators {
namespace {

RecordedRun MustRead(const std::filesystem::path& path) {
  auto run = ReadRun(path);
  INFO((run ? "" : run.error().text));
  REQUIRE(run);
  return *std::move(run);
}

/// Of the moment's kind; fails when it is of another one.
template <class T>
T ValueOf(const Moment& moment) {
  const T* value = std::get_if<T>(&moment.value);
  REQUIRE(value != nullptr);
  return *value;
}

struct Folder : test::TemporaryFolder {
  std::filesystem::path recording = *this / "recording.mcap";
};

TEST_CASE("values come back as the bus carried them", "[operator][replay]") {
  const Folder folder;
  RecordedFile file(folder.recording,
                    {{"robots", "w1/r1 w2/r2"}, {"run", "a-run"}, {"method", "teleop"}});
  RobotState state = samples::SampleState();
  state.world = "w2";
  Snapshot snapshot = samples::SampleSnapshot();
  snapshot.streamed = false;
  file.Write(bus::kInitialMap, "w1", 1.0, ToMessage(samples::SampleMap()));
  file.Write(bus::kTruth, "w1", 2.0, ToMessage(samples::SampleMap()));
  file.Write(bus::kBelief, "w2", 3.0, ToMessage(samples::SampleBelief()));
  file.Write(bus::kRobotGoals, "r2", 3.5, ToMessage(samples::SampleGoals()));
  file.Write(bus::kRobotState, "r2", 4.0, ToMessage(state));
  file.Write(bus::kSnapshot, "r1", 5.0, ToMessage(snapshot));
  file.Write(bus::kRobotMap, "r1", 6.0, ToMessage(samples::SampleMap()));
  file.Finish();
  const RecordedRun run = MustRead(folder.recording);
  CHECK(run.warnings.empty());
  CHECK(run.name == "a-run");
  const Timeline& timeline = run.timeline;
  CHECK(timeline.duration_s == Approx(5.0));
  CHECK(timeline.session.robots_size() == 2);
  CHECK(timeline.session.worlds_size() == 2);
  CHECK(timeline.session.drives());
  REQUIRE(timeline.moments.size() == 6);
  CHECK(ValueOf<InitialMap>(timeline.moments[0]).map.cells == samples::SampleMap().cells);
  CHECK(ValueOf<TrueMap>(timeline.moments[1]).world == "w1");
  CHECK(ValueOf<ReceivedBelief>(timeline.moments[2]).belief == samples::SampleBelief());
  CHECK(ValueOf<RobotState>(timeline.moments[3]) == state);
  CHECK(ValueOf<Snapshot>(timeline.moments[4]) == snapshot);
  CHECK(ValueOf<SeenMap>(timeline.moments[5]).robot == "r1");
}

TEST_CASE("a recording of conav 0.1 is read: its stop orders had another topic",
          "[operator][replay]") {
  constexpr bus::Topic<conav_msgs::msg::StopOrder> kHold{"/{}/hold", bus::kLatchedQos};
  constexpr bus::Topic<conav_msgs::msg::IntendedPath> kWay{"/{}/way", bus::kLatchedQos};
  const Folder folder;
  RecordedFile file(folder.recording);
  StopOrder order = samples::SampleStop();
  order.robot = "r1";
  file.Write(kHold, "r1", 1.0, ToMessage(order));
  file.Write(kWay, "r1", 2.0, conav_msgs::msg::IntendedPath());  // not shown, of any version
  file.Finish();
  const RecordedRun run = MustRead(folder.recording);
  CHECK(run.warnings.empty());
  CHECK(ValueOf<StopOrder>(run.timeline.moments.back()) == order);
}

TEST_CASE("topics of others, and messages that are none, are left out", "[operator][replay]") {
  const Folder folder;
  RecordedFile file(folder.recording);
  file.Write(bus::kRobotState, "r9", 1.0, ToMessage(samples::SampleState()));
  file.Write(bus::kRobotGoals, "r1", 1.0, ToMessage(samples::SampleGoals()));
  file.WriteBytes("/r1/state", 1.0, {0, 1, 0, 0, 9});
  conav_msgs::msg::RobotState lost = ToMessage(samples::SampleState());
  lost.pose().orientation().z(std::numeric_limits<double>::quiet_NaN());
  file.Write(bus::kRobotState, "r1", 2.0, lost);
  file.Write(bus::kRobotState, "r1", 3.0, ToMessage(samples::SampleState()));
  file.Finish();
  const RecordedRun run = MustRead(folder.recording);
  CHECK(run.timeline.moments.size() == 1);
  REQUIRE(run.warnings.size() == 1);
  CHECK_THAT(run.warnings[0], Catch::Contains("2 messages"));
}

TEST_CASE("topics that another version recorded with other fields are named, and left out",
          "[operator][replay]") {
  const std::string type = "conav_msgs/msg/RobotState";
  const std::string stop = "conav_msgs/msg/StopOrder";
  const auto now = [](const std::string& of) { return bag::ConavSchemas().at(of); };
  const Folder folder;
  RecordedFile file(folder.recording);
  file.WriteBytes("/r1/state", 1.0, {0, 1, 0, 0, 9},
                  {0, type, "ros2msg", "int32 cell\n" + now(type)});
  file.WriteBytes("/r1/stop", 1.0, {0, 1, 0, 0, 9},
                  {0, stop, "ros2msg", "# a comment\n" + now(stop)});
  file.Write(bus::kRobotMap, "r1", 2.0, ToMessage(samples::SampleMap()));
  file.Finish();
  const RecordedRun run = MustRead(folder.recording);
  CHECK(run.timeline.moments.size() == 1);
  REQUIRE(run.warnings.size() == 2);
  CHECK_THAT(run.warnings[0], Catch::StartsWith("/r1/state: "));
  CHECK_THAT(run.warnings[1], Catch::StartsWith("1 messages"));  // on /r1/stop
}

TEST_CASE("health, frames, plans and commands are taken up", "[operator][replay]") {
  const Folder folder;
  RecordedFile file(folder.recording);
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.hardware_id("sim");
  status.level(1);
  status.message("slow");
  diagnostic_msgs::msg::DiagnosticArray health;
  health.status({status, diagnostic_msgs::msg::DiagnosticStatus()});  // the second is not ours
  file.Write(bus::kDiagnostics, "", 1.0, health);
  sensor_msgs::msg::CompressedImage image;
  image.data({1, 2, 3});
  file.Write(bus::kCameraImage, "r1", 2.0, image);
  file.Write(bus::kInitialMap, "w1", 3.0, ToMessage(samples::SampleMap()));
  RobotState state = samples::SampleState();
  state.robot = "r1";
  state.stamp = {};
  state.goals_stamp = {};
  file.Write(bus::kRobotState, "r1", 4.0, ToMessage(state));
  file.Write(bus::kPlan, "r1", 5.0,
             ToPathMessage({}, std::vector<Cell>{{1, 1}}, samples::SampleMap().geometry()));
  file.Write(bus::kOperatorEvent, "", 6.0, ToMessage(samples::SampleEvent()));
  file.Finish();
  const Timeline timeline = MustRead(folder.recording).timeline;
  REQUIRE(timeline.moments.size() == 6);
  CHECK(ValueOf<ServiceHealth>(timeline.moments[0]) ==
        ServiceHealth{"sim", console::LEVEL_WARNING, "slow"});
  CHECK(ValueOf<StreamFrame>(timeline.moments[1]).jpeg == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(ValueOf<PlannedPath>(timeline.moments[4]).cells == std::vector<Cell>{{1, 1}});
  CHECK(ValueOf<console::Event>(timeline.moments[5]).kind() == console::EVENT_REFUSED);
}

TEST_CASE("parts that cannot be played are named", "[operator][replay]") {
  const Folder folder;
  RecordedFile(folder / "others.mcap", {{"run", "a-run"}}).Finish();
  RecordedFile(folder / "empty.mcap").Finish();
  for (const char* file : {"missing.mcap", "others.mcap", "empty.mcap"}) {
    CHECK_THAT(ReadRun(folder / file).error().text, Catch::Contains(file));
  }
}

}  // namespace
}  // namespace conav::operators
