// A recorded demo in the console's page: what a page sees at a place is what the recording holds there.
#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <fstream>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "operator/recording/mcap_file.h"
#include "support/packed_grid.h"
#include "support/temporary_folder.h"
#include "system/console_page.h"
#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;

namespace conav::operators {
namespace {

namespace fs = std::filesystem;
namespace msg = conav_msgs::msg;

/// The recorded messages of one topic.
template <class T>
std::vector<T> MessagesOf(const fs::path& file, const std::string& topic) {
  std::vector<T> messages;
  auto reader = bag::McapReader::Open(file);
  REQUIRE(reader);
  for (;;) {
    const auto next = reader->Next();
    REQUIRE(next);
    if (!*next) return messages;
    if ((**next).topic->channel.topic != topic) continue;
    REQUIRE(bus::TypeSupportOf<T>().deserialize((**next).data, &messages.emplace_back()));
  }
}

/// conav-replay on a free port.
class Replay {
 public:
  explicit Replay(const fs::path& run) {
    std::ofstream(folder_ / "index.html") << "<page>";
    process_.emplace("conav-replay",
                     fmt::format("{} --port 0 --web {} --url-file {}", run.string(),
                                 folder_.path().string(), (folder_ / "url").string()),
                     folder_ / "output");
    process_->Prints("Ctrl-C ends it.\n");
    INFO(process_->Output());
    const auto url = ReadFile(folder_ / "url");
    REQUIRE(url);
    port_ = std::stoi(url->substr(url->rfind(':') + 1));
  }
  int port() const { return port_; }
  int End() {
    process_->Signal(SIGINT);
    return process_->Wait(std::chrono::seconds(20)).exit_code;
  }

 private:
  test::TemporaryFolder folder_;
  std::optional<test::RunningProgram> process_;  // ends before its folder goes
  int port_ = 0;
};

class Page : public ConsolePage {
 public:
  explicit Page(int port) : ConsolePage(port) {
    ReadUntil([this] { return playback.duration() > 0.0; });
  }

  /// Pauses there.
  void Seek(double position) {
    console::ClientMessage seek;
    seek.mutable_seek()->set_position(position);
    seek.mutable_seek()->set_speed(0.0);
    Send(seek);
    do Read();
    while (playback.position() != position || playback.speed() != 0.0);
  }
  std::vector<console::Mark> Marks(console::MarkKind kind) const {
    std::vector<console::Mark> marks;
    for (const console::Mark& mark : playback.marks()) {
      if (mark.kind() == kind) marks.push_back(mark);
    }
    return marks;
  }
};

std::string WallsOf(const msg::BeliefMap& belief) {
  std::string walls;
  for (const float p : belief.wall_probability()) {
    walls.push_back(static_cast<char>(std::lround(255.0F * p)));
  }
  return walls;
}

}  // namespace

TEST_CASE("a page of a replay sees at each place what the recording holds there", "[replay]") {
  DemoRun demo("--headless --seed 7 --mapping-value 4");  // for more edits
  demo.EndsWell();
  const fs::path recording = demo.RunFolder() / "recording.mcap";
  const auto beliefs = MessagesOf<msg::BeliefMap>(recording, "/w1/belief");
  const auto states = MessagesOf<msg::RobotState>(recording, "/r1/state");
  const auto goals = MessagesOf<msg::RobotGoals>(recording, "/r1/goals");
  const auto snapshots = MessagesOf<msg::Snapshot>(recording, "/r1/snapshot");
  REQUIRE(beliefs.size() >= 3);
  REQUIRE(snapshots.size() >= 2);

  Replay replay(demo.RunFolder());
  Page page(replay.port());
  CHECK(page.welcome.mode() == console::MODE_REPLAY);
  const auto edits = page.Marks(console::MARK_EDIT);
  const auto taken = page.Marks(console::MARK_SNAPSHOT);
  REQUIRE(edits.size() == beliefs.size() - 1);
  REQUIRE(taken.size() == snapshots.size());
  CHECK(page.Marks(console::MARK_GOAL).size() == goals.back().total());

  page.Seek(page.playback.duration());
  const Cell last = ToDomain(states.back()).value().cell;
  CHECK(page.robot.cell().row() == last.row);
  CHECK(page.robot.cell().column() == last.column);
  CHECK(page.snapshots.size() == snapshots.size());
  CHECK(page.belief.revision() == beliefs.back().revision());
  CHECK(test::UnpackedCells(page.truth.cells()).size() == 13 * 13);
  const std::size_t all_events = page.events;
  CHECK(all_events >= edits.size());

  // Back and forth, edit by edit.
  for (const std::size_t i : {edits.size() - 1, std::size_t{0}, edits.size() / 2}) {
    page.Seek(edits[i].position());
    CHECK(page.belief.revision() == beliefs[i + 1].revision());
    CHECK(test::UnpackedCells(page.belief.walls()) == WallsOf(beliefs[i + 1]));
    CHECK(page.belief.edited_by() == beliefs[i + 1].edited_by());
  }
  CHECK(page.events < all_events);

  for (std::size_t i = 0; i < taken.size(); ++i) {
    page.Seek(taken[i].position());
    REQUIRE(page.snapshots.size() == i + 1);
    const msg::Snapshot& snapshot = snapshots[i];
    CHECK(page.snapshots.rbegin()->first == snapshot.sequence_number());
    const auto jpeg =
        Get(replay.port(), fmt::format("/pictures/r1/{}.jpg", snapshot.sequence_number()));
    CHECK(jpeg.status == 200);
    CHECK(jpeg.body == std::string(snapshot.data().begin(), snapshot.data().end()));
  }

  page.Seek(0.0);
  CHECK(page.snapshots.empty());
  CHECK_FALSE(page.Ask([](auto& request) { request.mutable_stop(); }).accepted());
  CHECK(replay.End() == 0);
}

}  // namespace conav::operators
