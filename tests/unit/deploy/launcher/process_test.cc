#include "launcher/process.h"

#include <poll.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "common/runtime/result.h"

using namespace conav::launcher;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

struct LogFile {
  fs::path path = fs::temp_directory_path() / ("conav_process_" + std::to_string(getpid()));
  ~LogFile() { fs::remove(path); }
  std::string Read() const {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

bool WaitFor(const std::function<bool()>& condition, std::chrono::milliseconds limit = 10s) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 5);
  }
  return true;
}

}  // namespace

TEST_CASE("a process writes into its log and its exit code is known", "[launcher][process]") {
  const LogFile log;
  Process process("child", {"sh", "-c", "echo out; echo err >&2; exit 3"}, log.path);
  REQUIRE(WaitFor([&] { return process.Poll(); }));
  CHECK(process.end()->Describe() == "exit code 3");
  CHECK(log.Read() == "out\nerr\n");
}

TEST_CASE("the signal that ended a process is named", "[launcher][process]") {
  const LogFile log;
  Process process("child", {"sleep", "600"}, log.path);
  process.Signal(SIGKILL);
  REQUIRE(WaitFor([&] { return process.Poll(); }));
  CHECK(process.end()->Describe() == "signal 9 (Killed)");
}

TEST_CASE("a program that does not exist is refused by its name", "[launcher][process]") {
  const LogFile log;
  CHECK_THROWS_WITH(Process("child", {"/nowhere/conav-sim"}, log.path),
                    Catch::Contains("/nowhere/conav-sim") && Catch::Contains("No such file"));
}

TEST_CASE("a group reports each end once", "[launcher][process]") {
  const LogFile log;
  ProcessGroup group;
  group.Start("short", {"true"}, log.path);
  group.Start("long", {"sleep", "600"}, log.path);
  std::vector<const Process*> ended;
  REQUIRE(WaitFor([&] {
    ended = group.TakeEnded();
    return !ended.empty();
  }));
  CHECK(ended[0]->name() == "short");
  CHECK(group.TakeEnded().empty());
}

TEST_CASE("a group is stopped at once when its processes obey", "[launcher][process]") {
  const LogFile log;
  ProcessGroup group;
  group.Start("a", {"sleep", "600"}, log.path);
  group.Start("b", {"sleep", "600"}, log.path);
  const auto start = std::chrono::steady_clock::now();
  CHECK(group.StopAll(10s).empty());
  CHECK(std::chrono::steady_clock::now() - start < 5s);
}

TEST_CASE("one process of a group is stopped and the others run on", "[launcher][process]") {
  const LogFile log;
  ProcessGroup group;
  const Process& a = group.Start("a", {"sleep", "600"}, log.path);
  const Process& b = group.Start("b", {"sleep", "600"}, log.path);
  const auto is_a = [](const Process& process) { return process.name() == "a"; };
  CHECK(group.Stop(10s, is_a).empty());
  CHECK_FALSE(a.running());
  CHECK(b.running());
  CHECK(group.Stop(10s, is_a).empty());  // has ended before
}

TEST_CASE("a process that ignores the request is killed and named", "[launcher][process]") {
  const LogFile log;
  ProcessGroup group;
  group.Start("stubborn", {"sh", "-c", "trap '' TERM; echo ready; while :; do sleep 1; done"},
              log.path);
  REQUIRE(WaitFor([&] { return log.Read() == "ready\n"; }));
  CHECK(group.StopAll(100ms) == std::vector<std::string>{"stubborn"});
}

TEST_CASE("the last lines of a log are those at its end", "[launcher][process]") {
  const LogFile log;
  std::ofstream(log.path) << "one\ntwo\nthree\n";
  CHECK(LastLines(log.path, 2) == std::vector<std::string>{"two", "three"});
  CHECK(LastLines(log.path, 9).size() == 3);
  CHECK(LastLines("/nowhere/log", 2).empty());
}
