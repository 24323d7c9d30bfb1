#include "system/launcher/demo_run.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <regex>

#include "common/runtime/file.h"

namespace conav::testing {
nlohmann::json Table(nlohmann::json result) {
  for (auto& robot : result["robots"]) {
    robot.erase("decision_ms_median");
    robot.erase("decision_ms_p99");
  }
  return {result["robots"], result["mapping_accuracy_after"], result["cell_accuracy_after"]};
}

DemoRun::DemoRun(const std::vector<std::string>& arguments,
                 const std::vector<std::string>& prefix) {
  const std::vector<std::string> own{CONAV_BIN_DIR "/conav",
                                     "demo",
                                     "--domain",
                                     std::to_string(TestDomain()),
                                     "--out",
                                     (folder_ / "runs").string(),
                                     "--json",
                                     (folder_ / "result.json").string()};
  std::vector<std::string> command = prefix;
  command.insert(command.end(), own.begin(), own.end());
  command.insert(command.end(), arguments.begin(), arguments.end());
  process_.emplace("conav", command, folder_ / "output.txt");
}

int DemoRun::Wait(std::chrono::seconds limit) {
  const bool ended = WaitUntil([this] { return process_->Poll(); }, limit);
  if (!ended) {
    // Asked to stop, so that the services' logs are complete.
    process_->Signal(SIGTERM);
    WaitUntil([this] { return process_->Poll(); }, std::chrono::seconds(20));
    FAIL("the demo did not end in time\n" << Story());
  }
  REQUIRE(process_->end()->signal == 0);
  return process_->end()->exit_code;
}

std::string DemoRun::Output() const { return ReadFile(folder_ / "output.txt").value_or(""); }

pid_t DemoRun::PidOf(const std::string& service) {
  const std::regex line("started " + service + R"( \(pid (\d+)\))");
  std::smatch match;
  std::string output;
  const bool found = WaitUntil(
      [&] {
        output = Output();
        return std::regex_search(output, match, line);
      },
      std::chrono::seconds(30));
  if (!found) FAIL("no pid of " << service << "\n" << Story());
  return std::stoi(match[1]);
}

void DemoRun::WaitForMoves() {
  const std::regex moved(R"(moves [1-9])");
  REQUIRE(WaitUntil([&] { return std::regex_search(Output(), moved); }, std::chrono::seconds(90)));
}

bool DemoRun::Prints(const std::string& text) const {
  return WaitUntil([&] { return Output().find(text) != std::string::npos; },
                   std::chrono::seconds(60));
}

nlohmann::json DemoRun::EndsWell() {
  const int code = Wait();
  INFO(Story());
  REQUIRE(code == 0);
  REQUIRE(Json().is_object());
  return Json();
}

nlohmann::json DemoRun::Json() const {
  const std::string text = ReadFile(folder_ / "result.json").value_or("");
  return text.empty() ? nlohmann::json() : nlohmann::json::parse(text);
}

std::filesystem::path DemoRun::RunFolder() const {
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "runs"))
    return entry.path();
  return {};
}

std::string DemoRun::Story() const {
  std::string story = Output();
  std::error_code none;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "runs", none)) {
    if (entry.path().extension() != ".log") continue;
    story += fmt::format("--- {}\n", entry.path().filename().string());
    for (const std::string& line : launcher::LastLines(entry.path(), 15)) story += line + "\n";
  }
  return story;
}

}  // namespace conav::testing
