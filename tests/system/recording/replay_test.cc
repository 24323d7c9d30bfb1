// A recorded demo in the console's page: what a page sees at a place is what the recording holds there.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/runtime/file.h"
#include "launcher/process.h"
#include "operator/recording/mcap_file.h"
#include "support/temporary_folder.h"
#include "system/console_page.h"
#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;
using conav::testing::WaitUntil;

namespace conav::operators {
namespace {

namespace fs = std::filesystem;
namespace msg = conav_msgs::msg;

/// The recorded messages of one topic, with how many messages came before each of them.
template <class T>
std::map<std::size_t, T> MessagesOf(const fs::path& file, const std::string& topic) {
  std::map<std::size_t, T> messages;
  auto reader = bag::McapReader::Open(file);
  REQUIRE(reader);
  for (std::size_t before = 0;; ++before) {
    const auto next = reader->Next();
    REQUIRE(next);
    if (!*next) return messages;
    if ((**next).topic->channel.topic != topic) continue;
    T message;
    REQUIRE(bus::TypeSupportOf<T>().deserialize((**next).data, &message));
    messages.emplace(before, std::move(message));
  }
}

/// The newest before message number `limit`.
template <class T>
const T& NewestBefore(const std::map<std::size_t, T>& messages, std::size_t limit) {
  const auto after = messages.lower_bound(limit);
  REQUIRE(after != messages.begin());
  return std::prev(after)->second;
}

/// conav-replay on a free port.
class Replay {
 public:
  explicit Replay(const fs::path& run) {
    std::ofstream(folder_ / "index.html") << "<page>";
    process_ = std::make_unique<launcher::Process>(
        "conav-replay",
        std::vector<std::string>{std::string(CONAV_BIN_DIR) + "/conav-replay", run.string(),
                                 "--port", "0", "--web", folder_.path().string(), "--url-file",
                                 (folder_ / "url").string()},
        folder_ / "output");
    const auto is_up = [&] { return Said().ends_with("Ctrl-C ends it.\n") || process_->Poll(); };
    REQUIRE(WaitUntil(is_up, std::chrono::seconds(60)));
    INFO(Said());
    const auto url = ReadFile(folder_ / "url");
    REQUIRE(url);
    port_ = std::stoi(url->substr(url->rfind(':') + 1));
  }
  int port() const { return port_; }
  std::string Said() const { return ReadFile(folder_ / "output").value_or(""); }
  int End() {
    process_->Signal(SIGINT);
    REQUIRE(WaitUntil([&] { return process_->Poll(); }, std::chrono::seconds(20)));
    return process_->end()->exit_code;
  }

 private:
  test::TemporaryFolder folder_;
  std::unique_ptr<launcher::Process> process_;
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
  DemoRun demo({"--headless", "--seed", "7"});
  demo.EndsWell();
  const fs::path recording = demo.RunFolder() / "recording.mcap";
  const auto beliefs = MessagesOf<msg::BeliefMap>(recording, "/w1/belief");
  const auto states = MessagesOf<msg::RobotState>(recording, "/r1/state");
  const auto snapshots = MessagesOf<msg::Snapshot>(recording, "/r1/snapshot");
  REQUIRE(beliefs.size() >= 3);
  REQUIRE(snapshots.size() >= 2);

  Replay replay(demo.RunFolder());
  Page page(replay.port());
  CHECK(page.welcome.mode() == console::MODE_REPLAY);
  const auto edits = page.Marks(console::MARK_EDIT);
  const auto marks = page.Marks(console::MARK_SNAPSHOT);
  REQUIRE(edits.size() == beliefs.size() - 1);
  REQUIRE(marks.size() == snapshots.size());
  CHECK(page.Marks(console::MARK_GOAL).size() == states.rbegin()->second.goals_total());

  page.Seek(page.playback.duration());
  const auto& last = states.rbegin()->second;
  CHECK(page.robot.cell().row() == last.cell().row());
  CHECK(page.robot.cell().column() == last.cell().column());
  CHECK(page.snapshots.size() == snapshots.size());
  CHECK(page.belief.revision() == beliefs.rbegin()->second.revision());
  CHECK(page.truth.cells().size() == 13 * 13);
  const std::size_t all_events = page.events;
  CHECK(all_events >= edits.size());

  // Back and forth, edit by edit.
  for (const std::size_t i : {edits.size() - 1, std::size_t{0}, edits.size() / 2}) {
    page.Seek(edits[i].position());
    const auto message = std::next(beliefs.begin(), static_cast<std::ptrdiff_t>(i) + 1);
    CHECK(page.belief.revision() == message->second.revision());
    CHECK(page.belief.walls() == WallsOf(message->second));
    CHECK(page.belief.edited_by() == message->second.edited_by());
  }
  CHECK(page.events < all_events);

  auto snapshot = snapshots.begin();
  for (std::size_t i = 0; i < snapshots.size(); ++i, ++snapshot) {
    page.Seek(marks[i].position());
    const auto& [number, message] = *snapshot;
    REQUIRE(page.snapshots.size() == i + 1);
    CHECK(page.snapshots.rbegin()->first == message.sequence_number());
    const msg::RobotState& state = NewestBefore(states, number);
    CHECK(page.robot.cell().row() == state.cell().row());
    CHECK(page.robot.cell().column() == state.cell().column());
    const auto jpeg =
        Get(replay.port(), fmt::format("/pictures/r1/{}.jpg", message.sequence_number()));
    CHECK(jpeg.status == 200);
    CHECK(jpeg.body == std::string(message.data().begin(), message.data().end()));
  }

  page.Seek(0.0);
  CHECK(page.snapshots.empty());
  CHECK_FALSE(page.Ask([](auto& request) { request.mutable_stop(); }).accepted());
  CHECK(replay.End() == 0);
}

}  // namespace conav::operators
