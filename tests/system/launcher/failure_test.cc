#include <catch2/catch.hpp>
#include <csignal>

#include "common/runtime/file.h"
#include "support/program_runner.h"
#include "support/taken_port.h"
#include "support/temporary_folder.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

using namespace std::chrono_literals;

// Slow enough that it does not end by itself before it is disturbed.
const std::string kSlowRun = "--headless --speed 4 --camera none";

bool Alive(pid_t pid) { return kill(pid, 0) == 0; }

}  // namespace

TEST_CASE("without the perception service the planner goes on by itself", "[demo]") {
  DemoRun demo("--headless --speed 20 --camera none");
  const pid_t nhpm = demo.PidOf("nhpm");
  demo.WaitForMoves();
  REQUIRE(kill(nhpm, SIGKILL) == 0);
  demo.EndsWell();
  CHECK_THAT(demo.Output(), Catch::Contains("nhpm (pid " + std::to_string(nhpm) + ") died"));
}

TEST_CASE("killing one of two perception replicas changes no result", "[demo]") {
  // A robot that is commanded later stands straighter, so turns must not count.
  const test::TemporaryFolder folder;
  const std::filesystem::path search = folder / "search.yaml";
  REQUIRE(WriteFile(search, "search: {reward: {view_turn: 0.0}}"));
  const std::string arguments =
      "--headless --speed 20 --camera none --seed 10 --nhpm-replicas 2 --search " + search.string();
  DemoRun undisturbed(arguments);
  // These go with wall time where --speed is not 0: a robot commanded later sets out from rest.
  const auto table = [](nlohmann::json result) {
    for (auto& robot : result["robots"]) {
      robot.erase("time_s");
      robot.erase("distance_m");
      robot.erase("low_level_steps");
    }
    return Table(result);
  };
  const auto expected = table(undisturbed.EndsWell());
  for (const std::string victim : {"nhpm-1", "nhpm-2"}) {
    DemoRun demo(arguments);
    const pid_t pid = demo.PidOf(victim);
    demo.WaitForMoves();
    REQUIRE(kill(pid, SIGKILL) == 0);
    const auto result = demo.EndsWell();
    CHECK(result["all_goals_reached"] == true);
    CHECK(table(result) == expected);
    CHECK_THAT(demo.Output(), Catch::Contains(victim + " (pid " + std::to_string(pid) + ") died") &&
                                  Catch::Contains("restarted " + victim));
    CHECK_THAT(demo.Story(), !Catch::Contains("using the embedded GLPF"));
  }
}

// The faults report's G12: "run goes on, ... result of the demo is lost". Here no file grows beyond 100 kB,
// as on a full disk.
TEST_CASE(
    "a run on a full disk goes on, writes its result, and leaves a recording that can be read",
    "[demo]") {
  DemoRun demo("--headless --camera none --seed 7 --method greedy --preset open21",
               "env --ignore-signal=XFSZ prlimit --fsize=100000");
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 1);
  const std::filesystem::path run = demo.RunFolder();
  CHECK(demo.Json()["all_goals_reached"] == true);
  CHECK(std::filesystem::exists(run / "metrics.json"));
  CHECK_FALSE(std::filesystem::exists(run / "episode.svg"));
  CHECK_THAT(demo.Output(),
             Catch::Contains("episode.svg: cannot write") && !Catch::Contains("\npicture "));
  const auto bag = test::RunProgram("conav-bag", (run / "recording.mcap").string());
  CHECK(bag.exit_code == 0);
  CHECK_THAT(ReadFile(run / "logs/recorder.log").value(), Catch::Contains("messages not recorded"));
  CHECK_THAT(bag.out, Catch::Contains("/r1/state"));
}

TEST_CASE("Ctrl-C stops every process and says so", "[demo]") {
  DemoRun demo(kSlowRun);
  std::vector<pid_t> pids;
  for (const char* service :
       {"recorder", "sim", "nhpm", "operator", "planner", "simulated-operator"}) {
    pids.push_back(demo.PidOf(service));
  }
  demo.WaitForMoves();
  demo.Signal(SIGINT);
  CHECK(demo.Wait(30s) == 1);
  INFO(demo.Story());
  CHECK_THAT(demo.Output(), Catch::Contains("interrupted"));
  CHECK_THAT(demo.Output(), !Catch::Contains("was killed"));
  for (const pid_t pid : pids) CHECK_FALSE(Alive(pid));
}

TEST_CASE("no service outlives a launcher that was killed", "[demo]") {
  DemoRun demo(kSlowRun);
  const pid_t sim = demo.PidOf("sim");
  const pid_t last = demo.PidOf("simulated-operator");
  demo.Signal(SIGKILL);
  CHECK(WaitUntil([&] { return !Alive(sim) && !Alive(last); }, 10s));
}

TEST_CASE("a second demo in the same domain is refused", "[demo]") {
  DemoRun first(kSlowRun);
  first.PidOf("sim");
  DemoRun second(kSlowRun);
  CHECK(second.Wait(30s) == 2);
  CHECK_THAT(second.Output(), Catch::Contains("domain " + std::to_string(TestDomain())) &&
                                  Catch::Contains("--domain"));
  first.Signal(SIGINT);
  first.Wait(30s);
}

TEST_CASE("a demo whose port is taken says so before it starts anything", "[demo]") {
  const test::TakenPort taken;
  const std::string option =
      fmt::format("{} {}", GENERATE("--console", "--headless --foxglove"), taken.port);
  DemoRun demo(option);
  CHECK(demo.Wait(30s) == 1);
  CHECK_THAT(demo.Output(),
             Catch::Contains(option.substr(option.rfind("--"))) && !Catch::Contains("started"));
}

TEST_CASE("wrong use of the demo ends with 2 before anything starts", "[demo]") {
  for (const std::string option :
       {"--robots 40", "--preset nope", "--map /none", "--colour red", "--water-level 3",
        "--radius 1", "--cell-size 0.05 --map x.yaml", "--method teleop --world waterway"}) {
    DemoRun demo(option);
    CHECK(demo.Wait(30s) == 2);
    CHECK_THAT(demo.Output(),
               Catch::Contains(option.substr(0, option.find(' '))) && !Catch::Contains("started"));
  }
}

TEST_CASE("a service that refuses its configuration ends with 1 and names the key", "[demo]") {
  const test::ProgramRunner service("conav-sim");
  REQUIRE(WriteFile(service / "c.yaml", "sim:\n  ros__parameters:\n    colour: red\n"));
  const auto ended = service.Run("--config c.yaml");
  CHECK(ended.exit_code == 1);
  CHECK_THAT(ended.text(), Catch::Contains("'colour'"));
}

}  // namespace conav::testing
