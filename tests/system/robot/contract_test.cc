#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/msg/convert.h"
#include "sim/config.h"
#include "support/loopback.h"
#include "support/program_runner.h"
#include "support/scoped_variable.h"
#include "support/service_process.h"

namespace conav::robot {
namespace {

/// Runs the doctor for a robot on the bus.
test::ProgramOutcome Examine(const test::ProgramRunner& doctor, const std::string& arguments,
                             const bus::ParticipantOptions& options) {
  return doctor.Run(fmt::format("robot {} --domain {} --interface lo --json report.json", arguments,
                                options.domain_id));
}

nlohmann::json ClausesIn(const test::ProgramRunner& doctor) {
  return nlohmann::json::parse(ReadFile(doctor / "report.json").value())["clauses"];
}

TEST_CASE("the simulator's robots keep every clause of the contract", "[robot][system]") {
  struct Row {
    std::string vendor, preset, step;
  };
  const Row row = GENERATE(Row{"cyclonedds", "conav13", ""}, Row{"fastdds", "conav13", ""},
                           Row{"cyclonedds", "waterway", " --step 3"});
  CAPTURE(row.vendor, row.preset);
  const test::ProgramRunner doctor("conav-doctor");
  sim::SimConfig config;
  config.bus = test::OnLoopback(row.vendor);
  config.camera.mode = "none";
  config.preset = row.preset;
  config.terrain.rows = 100;
  config.terrain.columns = 100;
  config.robots = {"r1", "r2"};
  config.speed = 2.0;
  std::ofstream(doctor / "sim.yaml") << DumpConfig("sim", config);
  test::ServiceProcess sim("conav-sim", doctor / "sim.yaml");
  const auto outcome = Examine(doctor, "r2" + row.step, config.bus);
  CAPTURE(outcome.out, outcome.error);
  CHECK(outcome.exit_code == 0);
  const auto clauses = ClausesIn(doctor);
  REQUIRE(clauses.size() == 23);
  for (const auto& clause : clauses) {
    CAPTURE(clause.dump());
    CHECK(clause["verdict"] == "holds");
  }
  CHECK(sim.End(SIGTERM).exit_code == 0);
}

TEST_CASE("doctor says which robot it cannot check, who drives it, or which clause is broken",
          "[robot][system]") {
  const test::ProgramRunner doctor("conav-doctor");
  const auto options = test::OnLoopback("cyclonedds");
  const auto nobody = Examine(doctor, "r9", options);
  CHECK(nobody.exit_code == 1);
  CHECK_THAT(nobody.error, Catch::Contains("/r9/state"));
  CHECK(doctor.Run("robot").exit_code == 2);
  CHECK(doctor.Run("robot r1 --domain 999").exit_code == 2);

  bus::Participant participant("driver", options);
  bus::Publisher<conav_msgs::msg::RobotState> states(participant, bus::kRobotState, "r1");
  bus::Send(states, ToMessage(RobotState{.world = "w1", .robot = "r1", .grid = {5, 5, 2.0}}));
  const auto without_map = Examine(doctor, "r1", options);
  CAPTURE(without_map.text());
  CHECK(without_map.exit_code == 1);
  const auto clauses = ClausesIn(doctor);
  CHECK(clauses[0]["verdict"] == "holds");
  CHECK(clauses[1]["name"] == "map");
  CHECK(clauses[1]["verdict"] == "BROKEN");
  CHECK(clauses[2]["verdict"] == "not checked");

  bus::Publisher<conav_msgs::msg::PlannerLease> leases(participant, bus::kPlannerLease);
  bus::Send(leases,
            ToMessage(PlannerLease{
                .node = "planner_7", .instance = "1", .robots = {"r1"}, .holds = {{"r1", 1}}}));
  const auto driven = Examine(doctor, "r1", options);
  CHECK(driven.exit_code == 1);
  CHECK_THAT(driven.error, Catch::Contains("planner_7") && Catch::Contains("r1"));
}

TEST_CASE("doctor says which ROS 2 nodes there are, and what conav would do to them",
          "[robot][system]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(vendor);
  const auto examine = [](const char* ros_distro) {
    const test::ScopedVariable distribution("ROS_DISTRO", ros_distro);
    return test::RunProgram("conav-doctor",
                            fmt::format("ros --domain {} --interface lo", test::TestDomain()));
  };
  CHECK_THAT(examine("jazzy").out, Catch::StartsWith("no ROS 2 node"));
  bus::ParticipantOptions options = test::OnLoopback(vendor);
  options.ros_distribution = bus::RosDistribution::kHumble;
  const bus::Participant turtle("turtle", options);
  for (const auto& [distribution, exit_code, advice] :
       {std::tuple("jazzy", 1, "HARMFUL"), std::tuple("", 0, "--ros humble"),
        std::tuple("humble", 0, "suits them")}) {
    const auto outcome = examine(distribution);
    CAPTURE(distribution, outcome.text());
    CHECK(outcome.exit_code == exit_code);
    CHECK_THAT(outcome.out, Catch::StartsWith("humble   /turtle\n") && Catch::Contains(advice));
  }
  options.ros_distribution = bus::RosDistribution::kJazzy;
  const bus::Participant stranger("stranger", options);
  const auto both = examine("");
  CHECK(both.exit_code == 1);
  CHECK_THAT(both.out, Catch::Contains("jazzy    /stranger") && Catch::Contains("both layouts"));
}

}  // namespace
}  // namespace conav::robot
