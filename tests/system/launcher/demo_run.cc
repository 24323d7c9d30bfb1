#include "system/launcher/demo_run.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <regex>

namespace conav::testing {
nlohmann::json Table(nlohmann::json result) {
  for (auto& robot : result["robots"]) {
    robot.erase("decision_ms_median");
    robot.erase("decision_ms_p95");
    robot.erase("decision_ms_p99");
  }
  return {result["robots"], result["mapping_accuracy_after"], result["cell_accuracy_after"]};
}

DemoRun::DemoRun(const std::string& arguments, const std::string& prefix)
    : RunningProgram("conav",
                     fmt::format("demo --domain {0} --out {1}/runs --json {1}/result.json {2}",
                                 TestDomain(), path().string(), arguments),
                     path() / "output.txt", prefix) {}

int DemoRun::Wait(std::chrono::seconds limit) {
  if (!Ends(limit)) {
    // Asked to stop, so that the services' logs are complete.
    Signal(SIGTERM);
    Ends(std::chrono::seconds(20));
    FAIL("the demo did not end in time\n" << Story());
  }
  const launcher::ProcessEnd end = RunningProgram::Wait();
  REQUIRE(end.signal == 0);
  return end.exit_code;
}

pid_t DemoRun::PidOf(const std::string& service) {
  const std::string line = "started " + service + " (pid ";
  if (!Prints(line)) FAIL("no pid of " << service << "\n" << Story());
  const std::string output = Output();
  return std::stoi(output.substr(output.find(line) + line.size()));
}

void DemoRun::WaitForMoves(const std::string& robot) {
  const std::regex moved(robot + R"( .*moves [1-9])");
  REQUIRE(WaitUntil([&] { return std::regex_search(Output(), moved); }, std::chrono::seconds(90)));
}

nlohmann::json DemoRun::EndsWell() {
  const int code = Wait();
  INFO(Story());
  REQUIRE(code == 0);
  REQUIRE(Json().is_object());
  return Json();
}

nlohmann::json DemoRun::ReachesAllGoals() {
  const nlohmann::json result = EndsWell();
  CHECK(result["all_goals_reached"] == true);
  for (const auto& robot : result["robots"]) {
    CHECK(robot["goals_total"] > 0);
    CHECK(robot["cell_moves"] > 0);
    CHECK(robot["decisions"] >= robot["cell_moves"]);
  }
  return result;
}

nlohmann::json DemoRun::Json() const {
  const std::string text = ReadFile(path() / "result.json").value_or("");
  return text.empty() ? nlohmann::json() : nlohmann::json::parse(text);
}

std::filesystem::path DemoRun::RunFolder() const {
  for (const auto& entry : std::filesystem::directory_iterator(path() / "runs"))
    return entry.path();
  return {};
}

std::string DemoRun::Story() const {
  std::string story = Output();
  std::error_code none;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path() / "runs", none)) {
    if (entry.path().extension() != ".log") continue;
    story += fmt::format("--- {}\n", entry.path().filename().string());
    for (const std::string& line : launcher::LastLines(entry.path(), 15)) story += line + "\n";
  }
  return story;
}

}  // namespace conav::testing
