// An eye tracker on the bus: Pupil Capture's stand-in (tests/support/pupil_standin.py, synthetic), conav-eye-tracker and the
// recorder as processes, and what conav gaze makes of the recording.
#include <fmt/core.h>
#include <signal.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/bus/topics.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "study/gaze/eye_tracker_service.h"
#include "study/gaze/participant_eye.h"
#include "support/loopback.h"
#include "support/program_runner.h"
#include "support/service_process.h"
#include "support/temporary_folder.h"
#include "support/test_domain.h"
#include "support/wait.h"
#include "system/study/pupil_standin.h"

namespace conav::gaze {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Standin;
using namespace std::chrono_literals;

/// The rest of the system, in a domain of its own.
struct Bus {
  bus::Participant participant{"operator", test::OnLoopback("cyclonedds")};
  bus::Publisher<conav_msgs::msg::StudyMark> marks{participant, bus::kStudyMark};
  bus::Publisher<conav_msgs::msg::PageLayout> layouts{participant, bus::kPageLayout};
  bus::Publisher<conav_msgs::msg::OperatorEvent> events{participant, bus::kOperatorEvent};
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map{participant, bus::kInitialMap, "w1"};
  bus::Subscriber<conav_msgs::msg::EyeClock> clocks{participant, bus::kEyeClock};
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> diagnostics{participant,
                                                                     bus::kDiagnostics};
  conav_msgs::msg::EyeClock clock;
  std::map<std::string, std::string> health;  // values of the tracker's newest report
  std::string message;                        // likewise

  void Take() {
    for (auto& newest : clocks.Take()) clock = newest;
    for (const auto& array : diagnostics.Take()) {
      for (const auto& status : array.status()) {
        if (status.name().find("eye_tracker") == std::string::npos) continue;
        message = status.message();
        health.clear();
        for (const auto& value : status.values()) health[value.key()] = value.value();
      }
    }
  }
  bool Waits(const std::function<bool()>& condition, std::chrono::seconds limit = 60s) {
    return test::WaitUntil(
        [&] {
          Take();
          return condition();
        },
        limit);
  }
  double Count(const std::string& name) const {
    const auto found = health.find(name);
    return found == health.end() ? 0.0 : std::stod(found->second);
  }

  void Mark(double pupil_time, const std::string& label, const std::string& method) {
    conav_msgs::msg::StudyMark mark;
    mark.utc(clock.utc() + pupil_time - clock.pupil_time());
    mark.label(label);
    mark.keys({"participant", "method", "step"});
    mark.values({"P01", method, "trial-" + method});
    REQUIRE(marks.Publish(mark));
  }
};

fs::path WriteConfig(const fs::path& folder, const std::string& section, const std::string& keys) {
  const fs::path file = folder / (section + ".yaml");
  const std::string bus = fmt::format("bus: {{domain_id: {}, interface: lo}}", test::TestDomain());
  REQUIRE(
      WriteFile(file, fmt::format("{}: {{ros__parameters: {{{}, {}}}}}\n", section, bus, keys)));
  return file;
}

conav_msgs::msg::PageArea Area(const std::string& name, double x, double y, double width,
                               double height) {
  conav_msgs::msg::PageArea area;
  area.name(name);
  area.x(x);
  area.y(y);
  area.width(width);
  area.height(height);
  return area;
}

/// The stand-in's areas on a page of 1000 x 700 pixels, whose surface is 50 pixels within its edges.
conav_msgs::msg::PageLayout Layout(double utc) {
  const auto placed = [](const char* name, double x, double y, double width, double height) {
    return Area(name, 50.0 + 900.0 * x, 50.0 + 600.0 * y, 900.0 * width, 600.0 * height);
  };
  conav_msgs::msg::PageLayout layout;
  layout.utc(utc);
  layout.width(1000.0);
  layout.height(700.0);
  layout.pixel_ratio(1.0);
  layout.areas({placed("picture", 0.05, 0.1, 0.3, 0.4), placed("map", 0.4, 0.1, 0.5, 0.8)});
  layout.tags({Area("tag0", 50.0, 50.0, 96.0, 96.0), Area("tag5", 854.0, 554.0, 96.0, 96.0)});
  layout.world("w1");
  layout.map_dx(900.0 * 0.05);  // 10 columns and 8 rows
  layout.map_dy(600.0 * 0.1);
  layout.map_x(50.0 + 900.0 * 0.4 + layout.map_dx() / 2.0);
  layout.map_y(50.0 + 600.0 * 0.1 + layout.map_dy() / 2.0);
  return layout;
}

nav_msgs::msg::OccupancyGrid Map(unsigned rows, unsigned columns) {
  nav_msgs::msg::OccupancyGrid map;
  map.info().height(rows);
  map.info().width(columns);
  map.data(std::vector<int8_t>(rows * columns, 0));
  return map;
}

std::vector<json> LinesOf(const fs::path& file) {
  std::istringstream text(ReadFile(file).value_or(""));
  std::vector<json> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line));
  return lines;
}

void CheckTrials(const json& trials, const json& expected) {
  REQUIRE(trials.size() == expected.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    CAPTURE(i, trials[i].dump());
    CHECK(trials[i]["method"] == expected[i]["method"]);
    CHECK(trials[i]["problem"] == "");
    // Marks go through UTC and back: a sample at the edge of a trial may change sides.
    for (const char* name : {"valid_share", "pcpd_mean", "pcpd_sd"}) {
      CHECK(trials[i][name].get<double>() ==
            Approx(expected[i][name].get<double>()).epsilon(0.005));
    }
    CHECK(trials[i]["blinks_per_min"].get<double>() ==
          Approx(expected[i]["blinks_per_min"].get<double>()).epsilon(0.001));
    CHECK(trials[i]["shifts_per_min"].get<double>() ==
          Approx(expected[i]["shifts_per_min"].get<double>()).epsilon(0.001));
    CHECK(trials[i]["fixations_per_min"]["picture"].get<double>() ==
          Approx(expected[i]["picture"].get<double>()).epsilon(0.001));
  }
}

/// Samples by cell of all trials together, of map_cells.csv.
std::map<std::pair<int, int>, int> CellsOf(const fs::path& file) {
  std::istringstream text(ReadFile(file).value());
  std::map<std::pair<int, int>, int> cells;
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::vector<std::string> fields;
    std::istringstream row(line);
    for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
    cells[{std::stoi(fields.at(7)), std::stoi(fields.at(8))}] += std::stoi(fields.at(9));
  }
  return cells;
}

TEST_CASE("the example configuration has the defaults, and an address names host and port",
          "[study][gaze]") {
  const EyeTrackerConfig defaults;
  EyeTrackerConfig example;
  const char* file = CONAV_SOURCE_DIR "/deploy/config/eye_tracker.yaml";
  ReadConfig(LoadParameters(file, "eye_tracker"), "eye_tracker", example);
  CHECK(example.address == defaults.address);
  CHECK(example.record == defaults.record);
  for (const char* address : {"127.0.0.1:50020", "tcp://127.0.0.1", "tcp://:50020", "tcp://a:"}) {
    YAML::Node node;
    node["address"] = address;
    EyeTrackerConfig config;
    CHECK_THROWS_WITH(ReadConfig(node, "eye_tracker", config), Catch::Contains("address"));
  }
}

TEST_CASE("what a tracker sees goes over the bus into a recording and measures the same as offline",
          "[study][gaze]") {
  test::ProgramRunner gaze("conav-gaze");
  const fs::path step = gaze / "P01/03-trial";
  fs::create_directories(step);
  const fs::path log = gaze / "standin.jsonl";
  Standin standin(fmt::format("--speed 0 --scale 0.3 --malformed --log '{}' --expect '{}'",
                              log.string(), (gaze / "expected.json").string()));
  const json expected = json::parse(ReadFile(gaze / "expected.json").value());
  test::ServiceProcess recorder(
      "conav-recorder",
      WriteConfig(step, "recorder",
                  fmt::format("robots: [w1/r1], file: '{}'", (step / "recording.mcap").string())));
  test::ServiceProcess tracker(
      "conav-eye-tracker",
      WriteConfig(
          step, "eye_tracker",
          fmt::format("address: '{}', record: true, recording_name: P01-3", standin.address())));
  Bus bus;
  REQUIRE(bus.Waits([&] {
    return bus.clock.utc() > 0.0 && bus.Count("subscribers") >= 1.0 &&
           bus.marks.matched_subscribers() >= 2 && bus.layouts.matched_subscribers() >= 1 &&
           bus.map.matched_subscribers() >= 1;
  }));
  CHECK(bus.clock.round_trip() < 0.5);
  REQUIRE(bus.map.Publish(Map(8, 10)));
  REQUIRE(bus.layouts.Publish(Layout(bus.clock.utc() - 5.0)));
  for (const json& period : expected["periods"]) {
    const auto kind = period["kind"].get<std::string>();
    bus.Mark(period["begin"], kind + " begin", period["method"]);
    bus.Mark(period["end"], kind + " end", period["method"]);
  }
  conav_msgs::msg::OperatorEvent event;
  event.text("drew a wall");
  REQUIRE(bus.events.Publish(event));
  standin.Play();
  standin.WaitForEnd();
  REQUIRE(bus.Waits([&] { return bus.Count("pupil") >= expected["pupils"].get<double>(); }));
  CHECK(bus.Count("malformed") == 4.0);
  REQUIRE(bus.Waits([&] {
    return bus.Count("annotations") >= 2.0 * static_cast<double>(expected["periods"].size()) + 1.0;
  }));
  tracker.End(SIGTERM);
  recorder.End(SIGTERM);

  const auto outcome = gaze.Run("P01 --out eyes --json trials.json");
  CAPTURE(outcome.text());
  REQUIRE(outcome.exit_code == 0);
  CheckTrials(json::parse(ReadFile(gaze / "trials.json").value())["trials"], expected["trials"]);
  std::map<std::pair<int, int>, int> cells;
  for (const json& cell : expected["cells"]) cells[{cell[0], cell[1]}] = cell[2];
  CHECK(CellsOf(gaze / "eyes/map_cells.csv") == cells);
  const auto measured = MeasureParticipant(gaze / "P01");
  REQUIRE(measured);
  REQUIRE(measured->trials.size() == expected["trials"].size());
  CHECK(measured->trials.front().step == "trial-teleop");

  std::vector<json> annotations;
  std::vector<std::string> commands;
  for (const json& line : LinesOf(log)) {
    if (line.contains("annotation")) annotations.push_back(line["annotation"]);
    if (line.contains("command")) commands.push_back(line["command"]);
  }
  REQUIRE(annotations.size() == 2 * expected["periods"].size() + 1);
  CHECK(annotations[0]["label"] == "baseline begin");
  CHECK(annotations[0]["duration"] == 0.0);
  CHECK(annotations[0]["method"] == "teleop");
  CHECK(annotations[0]["timestamp"].get<double>() ==
        Approx(expected["periods"][0]["begin"].get<double>()).margin(0.01));
  const auto is_event = [](const json& one) { return one["label"] == "operator event"; };
  CHECK(std::ranges::count_if(annotations, is_event) == 1);
  CHECK(commands == std::vector<std::string>{"R P01-3", "r"});
}

TEST_CASE("the tracker connects again when Pupil is started again, and says so meanwhile",
          "[study][gaze]") {
  const test::TemporaryFolder folder;
  auto standin = std::make_unique<Standin>("--scale 0.3");
  const std::string port = standin->port();
  test::ServiceProcess tracker(
      "conav-eye-tracker",
      WriteConfig(folder.path(), "eye_tracker", fmt::format("address: '{}'", standin->address())));
  Bus bus;
  REQUIRE(bus.Waits([&] { return bus.message == "receiving" && bus.Count("pupil") > 100.0; }));
  const double offset = bus.clock.pupil_time() - bus.clock.utc();
  standin->Kill();
  REQUIRE(bus.Waits([&] { return bus.message.starts_with("no eye tracker"); }));
  bus.clock = {};
  standin = std::make_unique<Standin>("--scale 0.3 --port " + port);
  REQUIRE(bus.Waits([&] { return bus.message == "receiving" && bus.clock.utc() > 0.0; }));
  CHECK(std::abs(bus.clock.pupil_time() - bus.clock.utc() - offset) > 1.0);  // another clock
  tracker.End(SIGTERM);
}

}  // namespace
}  // namespace conav::gaze
