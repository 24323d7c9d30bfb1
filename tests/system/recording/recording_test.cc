// What a demo leaves as recording.mcap, by our reader and by those of others.
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "operator/recording/mcap_file.h"
#include "support/child_process.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

std::filesystem::path RecordingOf(const DemoRun& demo) {
  return demo.RunFolder() / "recording.mcap";
}

/// What a reader prints, which must succeed.
nlohmann::json Run(const std::string& command) {
  test::ChildProcess reader(command);
  INFO(command);
  REQUIRE(reader.Wait() == 0);
  return nlohmann::json::parse(reader.text());
}

/// By @mcap/core and @foxglove/rosmsg2-serialization, see recording/read_recording.mjs. The topics
/// named in `last` have their last message.
nlohmann::json ReadByOthers(const std::filesystem::path& recording,
                            const std::vector<std::string>& last = {}) {
  std::string command = fmt::format("'{}' '{}/read_recording.mjs' '{}'", CONAV_NODE,
                                    CONAV_READERS_DIR, recording.string());
  for (const std::string& topic : last) command += fmt::format(" --last '{}'", topic);
  return Run(command);
}

/// By sql.js and @foxglove/rosmsg2-serialization: a rosbag2 folder that was made of `recording`.
nlohmann::json ReadBagByOthers(const std::filesystem::path& folder,
                               const std::filesystem::path& recording) {
  return Run(fmt::format("'{}' '{}/read_rosbag2.mjs' '{}' '{}'", CONAV_NODE, CONAV_READERS_DIR,
                         folder.string(), recording.string()));
}

/// By conav-bag; `arguments` as typed into a shell.
nlohmann::json ReadByConav(const std::filesystem::path& recording,
                           const std::string& arguments = "") {
  return Run(
      fmt::format("'{}/conav-bag' '{}' --json - {}", CONAV_BIN_DIR, recording.string(), arguments));
}

/// Messages by topic, in what either of them found. Others' readers go by messages, conav also lists
/// topics that have none.
std::map<std::string, int> CountsOf(const nlohmann::json& found) {
  std::map<std::string, int> counts;
  const nlohmann::json& topics = found["topics"];
  for (const auto& [name, topic] : topics.items()) {
    if (topics.is_array()) {
      counts[topic["topic"]] = topic["messages"];
    } else {
      counts[name] = topic["count"];
    }
  }
  std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
  return counts;
}

/// Messages by topic in all files of a run, as others read each: a recorder that was started again
/// goes on in recording-2.mcap.
std::map<std::string, int> CountsOfFilesByOthers(const std::filesystem::path& folder) {
  std::map<std::string, int> sum;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".mcap") continue;
    for (const auto& [topic, count] : CountsOf(ReadByOthers(entry.path()))) sum[topic] += count;
  }
  return sum;
}

}  // namespace

TEST_CASE("every message of a demo's recording decodes, and says what happened", "[recording]") {
  DemoRun demo("--headless --seed 7");
  demo.EndsWell();
  const auto found = ReadByOthers(RecordingOf(demo), {"/r1/state", "/r1/goals", "/w1/belief",
                                                      "/r1/snapshot", "/conav/planner/lease"});
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
  CHECK(topics["/r1/goals"]["last"]["reached"].size() == robot["goals_total"]);
  CHECK(state["moves"] == robot["cell_moves"]);
  CHECK(state["low_level_steps"] == robot["low_level_steps"]);
  CHECK(topics["/r1/state"]["publish_time_s"] == Approx(robot["time_s"].get<double>()));
  CHECK(topics["/r1/snapshot"]["count"] == robot["pictures"]);
  CHECK(topics["/r1/snapshot"]["last"]["format"] == "jpeg");
  CHECK(topics["/r1/search"]["count"] == robot["decisions"]);
  const nlohmann::json belief = topics["/w1/belief"]["last"];
  CHECK(belief["map_info"]["height"] == 13);
  CHECK(belief["wall_probability"]["length"] == 13 * 13);
  // A late subscriber gets the newest map, not those before it.
  CHECK(topics["/w1/belief"]["count"].get<int>() <= belief["revision"].get<int>() + 1);
  // Recorded to the end: a planner says when it leaves.
  CHECK(topics["/conav/planner/lease"]["last"]["leaving"] == true);
}

TEST_CASE("conav bag finds what others' readers find, and so does the rosbag2 folder that it makes",
          "[recording]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  // Long enough that the recorder is found by all: what is not latched is not sent to it before.
  DemoRun demo("--headless --seed 7 --camera none --robots 2 --speed 20 --dds " + dds);
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
       {"/r1/state", "/r2/state", "/r2/command", "/r1/map", "/r1/odom", "/r1/tf", "/r1/tf_static",
        "/tf", "/tf_static", "/r1/robot_description", "/w1/truth", "/w1/goals", "/w1/belief/map",
        "/clock", "/rosout", "/diagnostics", "/conav/operator/request", "/conav/operator/reply",
        "/conav/perception/request"}) {
    CAPTURE(topic);
    CHECK(counts.contains(topic));
  }
}

TEST_CASE("a run goes on without its recorder, and what was recorded can be read", "[recording]") {
  DemoRun demo("--headless --speed 20 --camera none");
  const pid_t recorder = demo.PidOf("recorder");
  const auto has_states = [&] {
    auto reader = bag::McapReader::Open(RecordingOf(demo));
    return reader && reader->message_count() > 100;
  };
  REQUIRE(WaitUntil(has_states, std::chrono::seconds(60)));
  REQUIRE(kill(recorder, SIGKILL) == 0);
  demo.EndsWell();
  CHECK_THAT(demo.Output(), Catch::Contains(fmt::format("recorder (pid {}) died", recorder)));
  const auto conav = ReadByConav(RecordingOf(demo));
  CHECK(conav["finished"] == false);
  CHECK(ReadByOthers(RecordingOf(demo))["finished"] == false);
  CHECK(CountsOf(conav) == CountsOfFilesByOthers(demo.RunFolder()));
  CHECK(CountsOf(conav)["/r1/state"] > 0);
  const auto silent = std::ranges::find(conav["topics"], "/r1/drive",
                                        [](const auto& topic) { return topic["topic"]; });
  REQUIRE(silent != conav["topics"].end());
  CHECK((*silent)["messages"] == 0);
}

}  // namespace conav::testing
