#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim/config.h"
#include "support/loopback.h"
#include "support/program_runner.h"
#include "support/service_process.h"

namespace conav::robot {
namespace {

TEST_CASE("the simulator's robots keep every clause of the contract", "[robot][system]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const test::ProgramRunner doctor("conav-doctor");
  sim::SimConfig config;
  config.bus = test::OnLoopback(vendor);
  config.camera.mode = "none";
  config.robots = {"r1", "r2"};
  config.speed = 2.0;
  std::ofstream(doctor / "sim.yaml") << DumpConfig("sim", config);
  test::ServiceProcess sim("conav-sim", doctor / "sim.yaml");
  const std::string bus = fmt::format("--domain {} --interface lo", config.bus.domain_id);
  const auto outcome = doctor.Run("robot r2 " + bus + " --json report.json");
  CAPTURE(outcome.out, outcome.error);
  CHECK(outcome.exit_code == 0);
  const auto report = nlohmann::json::parse(ReadFile(doctor / "report.json").value());
  REQUIRE(report["clauses"].size() == 20);
  for (const auto& clause : report["clauses"]) {
    CAPTURE(clause.dump());
    CHECK(clause["verdict"] == "holds");
  }
  const auto nobody = doctor.Run("robot r9 " + bus);
  CHECK(nobody.exit_code == 1);
  CHECK_THAT(nobody.error, Catch::Contains("/r9/state"));
  CHECK(doctor.Run("robot").exit_code == 2);
  CHECK(doctor.Run("robot r1 --domain 999").exit_code == 2);
  CHECK(sim.End(SIGTERM).exit_code == 0);
}

}  // namespace
}  // namespace conav::robot
