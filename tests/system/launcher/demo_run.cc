#include "system/launcher/demo_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <iterator>
#include <regex>

namespace conav::testing {
namespace {

namespace fs = std::filesystem;

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

bool WaitUntil(const std::function<bool()>& condition, std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 20);
  }
  return true;
}

DemoRun::DemoRun(const std::vector<std::string>& arguments,
                 const std::vector<std::string>& prefix) {
  std::string pattern = (fs::temp_directory_path() / "conav-demo-XXXXXX").string();
  REQUIRE(mkdtemp(pattern.data()) != nullptr);
  folder_ = pattern;
  std::vector<std::string> command = prefix;
  for (const std::string& word :
       {std::string(CONAV_BIN_DIR) + "/conav", std::string("demo"), std::string("--domain"),
        std::to_string(TestDomain()), std::string("--out"), (folder_ / "runs").string(),
        std::string("--json"), (folder_ / "result.json").string()}) {
    command.push_back(word);
  }
  command.insert(command.end(), arguments.begin(), arguments.end());
  process_ = std::make_unique<launcher::Process>("conav", command, folder_ / "output.txt");
}

DemoRun::~DemoRun() {
  process_.reset();
  fs::remove_all(folder_);
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

std::string DemoRun::Output() const { return ReadFile(folder_ / "output.txt"); }

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

bool DemoRun::WaitForMoves() {
  const std::regex moved(R"(moves [1-9])");
  return WaitUntil([&] { return std::regex_search(Output(), moved); }, std::chrono::seconds(90));
}

nlohmann::json DemoRun::Json() const {
  const std::string text = ReadFile(folder_ / "result.json");
  return text.empty() ? nlohmann::json() : nlohmann::json::parse(text);
}

fs::path DemoRun::RunFolder() const {
  for (const auto& entry : fs::directory_iterator(folder_ / "runs")) return entry.path();
  return {};
}

std::string DemoRun::Story() const {
  std::string story = Output();
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "runs", none)) {
    if (entry.path().extension() != ".log") continue;
    story += fmt::format("--- {}\n", entry.path().filename().string());
    for (const std::string& line : launcher::LastLines(entry.path(), 15)) story += line + "\n";
  }
  return story;
}

}  // namespace conav::testing
