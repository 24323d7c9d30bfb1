#include "launcher/process.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"
#include "support/wait.h"

namespace conav::launcher {
namespace {

using namespace std::chrono_literals;
using test::WaitUntil;

/// A log to write into, and a group of processes that write there.
struct Log {
  Process& Start(const std::string& name, const std::vector<std::string>& arguments) {
    return group.Start(name, arguments, path);
  }
  std::string Read() const { return ReadFile(path).value_or(""); }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder / "log";
  ProcessGroup group;
};

TEST_CASE("a process writes into its log, and how it ended is known", "[launcher]") {
  const Log log;
  Process process("child", {"sh", "-c", "echo out; echo err >&2; exit 3"}, log.path);
  REQUIRE(WaitUntil([&] { return process.Poll(); }));
  CHECK_THAT(process.end()->Describe(), Catch::Contains("3"));
  CHECK(log.Read() == "out\nerr\n");
  Process killed("child", {"sleep", "600"}, log.path);
  killed.Signal(SIGKILL);
  REQUIRE(WaitUntil([&] { return killed.Poll(); }));
  CHECK_THAT(killed.end()->Describe(), Catch::Contains("signal 9"));
}

TEST_CASE("a program that does not exist is refused by its name", "[launcher]") {
  CHECK_THROWS_WITH(Process("child", {"/nowhere/conav-sim"}, "/dev/null"),
                    Catch::Contains("/nowhere/conav-sim"));
}

TEST_CASE("a group reports each end once", "[launcher]") {
  Log log;
  log.Start("short", {"true"});
  log.Start("long", {"sleep", "600"});
  std::vector<const Process*> ended;
  REQUIRE(WaitUntil([&] { return !(ended = log.group.TakeEnded()).empty(); }));
  CHECK(ended[0]->name() == "short");
  CHECK(log.group.TakeEnded().empty());
}

TEST_CASE("a group stops at once, in part or whole, when its processes obey", "[launcher]") {
  Log log;
  const Process& a = log.Start("a", {"sleep", "600"});
  const Process& b = log.Start("b", {"sleep", "600"});
  const auto is_a = [](const Process& process) { return process.name() == "a"; };
  const auto start = std::chrono::steady_clock::now();
  CHECK(log.group.Stop(10s, is_a).empty());
  CHECK_FALSE(a.running());
  CHECK(b.running());
  CHECK(log.group.Stop(10s, is_a).empty());  // has ended before
  CHECK(log.group.StopAll(10s).empty());
  CHECK_FALSE(b.running());
  CHECK(std::chrono::steady_clock::now() - start < 5s);
}

TEST_CASE("a process that ignores the request is killed and named", "[launcher]") {
  Log log;
  log.Start("stubborn", {"sh", "-c", "trap '' TERM; echo ready; while :; do sleep 1; done"});
  REQUIRE(WaitUntil([&] { return log.Read() == "ready\n"; }));
  CHECK(log.group.StopAll(100ms) == std::vector<std::string>{"stubborn"});
}

TEST_CASE("the last lines of a log are those at its end", "[launcher]") {
  const Log log;
  REQUIRE(WriteFile(log.path, "one\ntwo\nthree\n"));
  CHECK(LastLines(log.path, 2) == std::vector<std::string>{"two", "three"});
  CHECK(LastLines(log.path, 9).size() == 3);
  CHECK(LastLines("/nowhere/log", 2).empty());
}

TEST_CASE("a process starts again later each time, until it has died too often", "[launcher]") {
  constexpr Clock::TimePoint kBegin{};
  constexpr Clock::TimePoint kLater = kBegin + 10min;
  RestartPolicy policy;
  const ProcessEnd killed{0, SIGKILL};
  for (const auto delay : {100ms, 200ms, 400ms, 800ms}) {
    const auto restart = policy.Ended(killed, kBegin, kLater);
    REQUIRE(restart);
    CHECK(*restart == kLater + delay);
  }
  const auto once_more = policy.Ended(killed, kBegin, kLater + 60s);
  REQUIRE_FALSE(once_more);
  CHECK_THAT(once_more.error().text, Catch::Contains("5 times"));
  // One that ran for a minute since is forgiven.
  CHECK(policy.Ended(killed, kBegin, kLater + 130s));
}

TEST_CASE("a process that fails at its start is not started again", "[launcher]") {
  constexpr Clock::TimePoint kBegin{};
  struct Row {
    ProcessEnd end;
    std::chrono::seconds ran;
    bool restarts;
  };
  for (const Row& row : {Row{{1, 0}, 0s, false}, Row{{2, 0}, 4s, false}, Row{{1, 0}, 5s, true},
                         Row{{0, 0}, 0s, true}, Row{{0, SIGSEGV}, 0s, true}}) {
    CAPTURE(row.end.Describe(), row.ran.count());
    CHECK(RestartPolicy().Ended(row.end, kBegin, kBegin + row.ran).has_value() == row.restarts);
  }
}

}  // namespace
}  // namespace conav::launcher
