// What a demo leaves as recording.mcap, by our reader and by those of others.
#include <fmt/format.h>
#include <signal.h>

#include <catch2/catch.hpp>
#include <set>

#include "operator/recording/mcap_file.h"
#include "recording/recording_check.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

std::filesystem::path RecordingOf(const DemoRun& demo) {
  return demo.RunFolder() / "recording.mcap";
}

}  // namespace

TEST_CASE("every message of a demo's recording decodes, and says what happened", "[recording]") {
  DemoRun demo({"--headless", "--seed", "7"});
  demo.EndsWell();
  const auto found = ReadByOthers(
      RecordingOf(demo), {"/r1/state", "/w1/belief", "/r1/snapshot", "/conav/planner/lease"});
  CHECK(found["profile"] == "ros2");
  CHECK(found["finished"] == true);
  const nlohmann::json facts = found["metadata"]["conav"];
  CHECK(facts["seed"] == "7");
  CHECK(facts["method"] == "ig-mcts");
  CHECK(facts["robots"] == "w1/r1");
  CHECK(facts["run"] == demo.RunFolder().filename().string());

  const nlohmann::json robot = demo.Json()["robots"][0];
  const nlohmann::json& topics = found["topics"];
  const nlohmann::json state = topics["/r1/state"]["last"];
  CHECK(state["robot"] == "r1");
  CHECK(state["goals_reached"].size() == robot["goals_total"]);
  CHECK(state["cell_moves"] == robot["cell_moves"]);
  CHECK(state["low_level_steps"] == robot["low_level_steps"]);
  CHECK(topics["/r1/state"]["publish_time_s"] == Approx(robot["time_s"].get<double>()));
  CHECK(topics["/r1/snapshot"]["count"] == robot["pictures"]);
  CHECK(topics["/r1/snapshot"]["last"]["format"] == "jpeg");
  CHECK(topics["/r1/search"]["count"] == robot["decisions"]);
  const nlohmann::json belief = topics["/w1/belief"]["last"];
  CHECK(belief["rows"] == 13);
  CHECK(belief["wall_probability"]["length"] == 13 * 13);
  // Who is found late gets the newest map, not those before it.
  CHECK(topics["/w1/belief"]["count"].get<int>() <= belief["revision"].get<int>() + 1);
  // Recorded to the end: a planner says when it leaves.
  CHECK(topics["/conav/planner/lease"]["last"]["leaving"] == true);
}

TEST_CASE("conav bag finds what others' readers find, and so does the rosbag2 folder that it makes",
          "[recording]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  // Long enough that the recorder is found by all: what is not latched is not sent to it before.
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none", "--robots", "2", "--dds", dds,
                "--speed", "20"});
  demo.EndsWell();
  const auto recording = RecordingOf(demo);
  const auto folder = demo.RunFolder() / "bag";
  const auto conav = ReadByConav(demo.RunFolder(), fmt::format("--rosbag2 '{}'", folder.string()));
  const auto others = ReadByOthers(recording);
  CHECK(conav["finished"] == true);
  CHECK(conav["bytes"] == std::filesystem::file_size(recording));
  CHECK(conav["metadata"] == others["metadata"]);
  const auto counts = CountsOf(conav);
  CHECK(counts == CountsOf(others));
  CHECK(counts == CountsOf(ReadBagByOthers(folder, recording)));
  for (const char* topic :
       {"/r1/state", "/r2/state", "/r2/command", "/r1/map", "/r1/odom", "/r1/tf", "/w1/truth",
        "/w1/goals", "/w1/belief/map", "/clock", "/rosout", "/diagnostics",
        "/conav/operator/request", "/conav/operator/reply", "/conav/perception/request"}) {
    CAPTURE(topic);
    CHECK(counts.contains(topic));
  }
}

TEST_CASE("streamed pictures are recorded when asked for", "[recording]") {
  const std::string stream = "/r1/camera/image/compressed";
  std::vector<std::string> arguments{"--headless", "--seed", "9", "--method", "teleop"};
  DemoRun without(arguments);
  without.EndsWell();
  CHECK_FALSE(CountsOf(ReadByOthers(RecordingOf(without))).contains(stream));
  arguments.emplace_back("--streams");
  DemoRun with(arguments);
  with.EndsWell();
  const auto found = ReadByOthers(RecordingOf(with), {stream});
  CHECK(CountsOf(found)[stream] > 0);
  CHECK(found["topics"][stream]["last"]["format"] == "jpeg");
}

TEST_CASE("a run goes on without its recorder, and what was recorded can be read", "[recording]") {
  DemoRun demo({"--headless", "--speed", "20", "--camera", "none"});
  const pid_t recorder = demo.PidOf("recorder");
  const auto has_states = [&] {
    auto reader = bag::McapReader::Open(RecordingOf(demo));
    return reader && reader->message_count() > 100;
  };
  REQUIRE(WaitUntil(has_states, std::chrono::seconds(60)));
  REQUIRE(kill(recorder, SIGKILL) == 0);
  demo.EndsWell();
  CHECK_THAT(demo.Output(), Catch::Contains(fmt::format("recorder (pid {}) died", recorder)) &&
                                Catch::Contains("the run continues without a recording"));
  const auto conav = ReadByConav(RecordingOf(demo));
  const auto others = ReadByOthers(RecordingOf(demo));
  CHECK(conav["finished"] == false);
  CHECK(others["finished"] == false);
  CHECK(CountsOf(conav) == CountsOf(others));
  CHECK(CountsOf(conav)["/r1/state"] > 0);
}

TEST_CASE("a demo that shall not be recorded is not", "[recording]") {
  DemoRun demo({"--headless", "--camera", "none", "--no-recording"});
  demo.EndsWell();
  CHECK_FALSE(std::filesystem::exists(RecordingOf(demo)));
  CHECK_THAT(demo.Output(), !Catch::Contains("started recorder"));
}

}  // namespace conav::testing
