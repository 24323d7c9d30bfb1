// The operator service with a recording: what goes over the bus becomes a segment file.
#include "common/runtime/text.h"
#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "integration/operator/operator_bench.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kTruth = {"######", "##   #", "# ## #", "#   ##", "######"};

OperatorConfig RecordingConfigFor(const TemporaryFolder& folder) {
  OperatorConfig config = ConfigFor(folder / "operator.db");
  config.recording.file = (folder / "segments.pb.zst").string();
  config.recording.participant = "p07";
  config.recording.session = "s1";
  config.recording.mazes = {"w1=conav13@7"};
  return config;
}

Snapshot SentSnapshot(std::uint64_t sequence_number) {
  Snapshot snapshot = SnapshotOf(sequence_number);
  snapshot.cell = {1, 2};
  snapshot.width = snapshot.height = 1;
  snapshot.jpeg = {0xFF, 0xD8, 0xFF};
  snapshot.visible = {{{1, 2}, {1, 3}}, {{0, 2}}};
  snapshot.path = {{1, 1}, {1, 2}};
  snapshot.goals_left.clear();
  return snapshot;
}

/// A service that records.
struct Session : OperatorBench {
  explicit Session(const OperatorConfig& config, std::uint64_t snapshots = 0)
      : OperatorBench(config) {
    REQUIRE(truth.Publish(ToMessage(MapUpdate{{0}, 1.5, DrawnTruth(kTruth)})));
    sim.PublishInitialMap(kMap);
    sim.PublishState({1, 1}, 5, snapshots);
    service.Step();
  }

  void Send(std::uint64_t sequence_number) {
    REQUIRE(sim.snapshot.Publish(ToMessage(SentSnapshot(sequence_number))));
    service.Step();
  }
  template <class Body>
  void Ask(const Body& body) {
    REQUIRE(OperatorBench::Ask(body).accepted);
  }

  bus::Publisher<nav_msgs::msg::OccupancyGrid> truth{sim.participant, bus::kTruth, "w1"};
};

TEST_CASE("A session is recorded segment by segment, readable while it goes on",
          "[operator][integration]") {
  const TemporaryFolder folder;
  Session session(RecordingConfigFor(folder));
  session.Send(1);
  session.Ask(EditRequest{0, {{{1, 1}, true}}});
  session.Ask(GuideRequest{"r1", {{1, 2}, {1, 3}}, 1, 60.0});
  session.Send(2);
  session.Ask(GuideRequest{"r1", {{1, 2}, {1, 3}}, 2, 60.0});
  const auto set = ReadSegmentFile(folder / "segments.pb.zst");
  REQUIRE(set);
  REQUIRE(set->trajectories.size() == 1);
  const Trajectory& trajectory = set->trajectories[0];
  CHECK(trajectory.origin == SegmentOrigin::kPerson);
  CHECK(trajectory.participant == "p07");
  CHECK(trajectory.session == "s1");
  CHECK(trajectory.world == "conav13");
  CHECK(trajectory.world_seed == 7);
  CHECK(trajectory.truth == DrawnTruth(kTruth));
  CHECK(trajectory.final_mapping_accuracy == 0.5);
  REQUIRE(trajectory.segments.size() == 2);
  const Segment& first = trajectory.segments[0];
  CHECK(LabelsOf(first).add[{1, 1}] == 1);
  CHECK(EditCount(first) == 1);
  CHECK(first.goals_reached == 1);  // one in all, none left
  CHECK(first.image.empty());
  CHECK(EditCount(trajectory.segments[1]) == 0);
}

TEST_CASE("A segment that is open at the end is recorded when it was edited",
          "[operator][integration]") {
  const TemporaryFolder folder;
  {
    Session session(RecordingConfigFor(folder));
    session.Send(1);
    session.Ask(EditRequest{0, {{{1, 1}, true}}});
  }
  CHECK(SegmentCount(ReadSegmentFile(folder / "segments.pb.zst").value()) == 1);
}

TEST_CASE("A service that starts again records a new trajectory and no old picture",
          "[operator][integration]") {
  const TemporaryFolder folder;
  {
    Session session(RecordingConfigFor(folder));
    session.Send(1);
    session.Ask(EditRequest{0, {{{1, 1}, true}}});
    session.Ask(GuideRequest{"r1", {{1, 2}}, 1, 60.0});
  }
  Session again(RecordingConfigFor(folder), 1);
  again.Send(1);  // repeated by the bus for late subscribers
  again.Send(2);
  const auto bert = [&](const auto& body) {
    OperatorClient client(again.client_participant, again.clock, {"bert", 0.25, 10.0});
    client.Send("w1", body, {});
    again.service.Step();
  };
  bert(GuideRequest{"r1", {{1, 2}}, 2, 60.0});
  const auto set = ReadSegmentFile(folder / "segments.pb.zst");
  REQUIRE(set);
  REQUIRE(set->trajectories.size() == 2);
  CHECK(set->trajectories[1].segments.size() == 1);
  CHECK(set->trajectories[1].segments[0].query.belief[{1, 1}] == 1.0F);
}

TEST_CASE("A file that cannot be recorded to stops the start by name", "[operator][integration]") {
  const TemporaryFolder folder;
  OperatorConfig config = RecordingConfigFor(folder);
  config.recording.file = (folder / "none/segments.pb.zst").string();
  CHECK_THROWS_WITH(Session(config), Catch::Contains("operator.recording.file") &&
                                         Catch::Contains("none/segments.pb.zst"));
  config = RecordingConfigFor(folder);
  config.recording.mazes = {"conav13"};
  CHECK_THROWS_WITH(Session(config),
                    Catch::Contains("operator.recording.mazes") && Catch::Contains("conav13"));
}

TEST_CASE("Pictures are kept next to the file where asked for, a segment without its one as well",
          "[operator][integration]") {
  const TemporaryFolder folder;
  OperatorConfig config = RecordingConfigFor(folder);
  config.recording.pictures = true;
  Session session(config);
  std::filesystem::create_directories(folder / "pictures/s1-r1-000001.jpg");  // cannot be replaced
  for (const std::uint64_t snapshot : {1U, 2U}) {
    session.Send(snapshot);
    session.Ask(GuideRequest{"r1", {{1, 2}}, snapshot, 60.0});
  }
  const auto set = ReadSegmentFile(folder / "segments.pb.zst");
  REQUIRE(SegmentCount(set.value()) == 2);
  CHECK(set->trajectories[0].segments[0].image.empty());
  const Segment& segment = set->trajectories[0].segments[1];
  CHECK(segment.image == "pictures/s1-r1-000002.jpg");
  CHECK(segment.image_sha256 == Sha256Hex("\xFF\xD8\xFF"));
  CHECK(std::filesystem::file_size(folder / segment.image) == 3);
}

TEST_CASE("Names that are no part of a file's name stop the start", "[operator][integration]") {
  const auto read = [](const char* key, const std::string& name) {
    YAML::Node section;
    section[key] = name;
    SegmentOptions config;
    ReadConfig(section, "operator.recording", config);
  };
  for (const char* good : {"", "p07", "simulated operator", "Zoë", "..", "2026-01-01"}) {
    CHECK_NOTHROW(read("session", good));
    CHECK_NOTHROW(read("participant", good));
  }
  for (const char* bad : {"../x", "a/b", "a\nb", "\xFF", "\x7F"}) {
    CHECK_THROWS_WITH(read("session", bad), Catch::StartsWith("operator.recording.session = "));
    CHECK_THROWS_WITH(read("participant", bad),
                      Catch::StartsWith("operator.recording.participant = "));
  }
}

}  // namespace
}  // namespace conav::operators
