// conav-operator and conav-simulated-operator as real processes on real DDS, next to a hand-made
// simulator.
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <functional>

#include "integration/operator/hand_made_sim.h"
#include "operator/simulated/config.h"
#include "support/loopback.h"
#include "support/service_process.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

/// Guidance for r1 that `wanted` accepts, or a failure after 20 s.
Guidance WaitForGuidance(HandMadeSim& sim, const std::function<bool(const Guidance&)>& wanted) {
  const SteadyClock clock;
  const auto deadline = clock.Now() + 20s;
  while (clock.Now() < deadline) {
    sim.participant.Wait(100ms);
    for (const auto& message : sim.guidance.Take()) {
      const auto guidance = ToDomain(message);
      REQUIRE(guidance.has_value());
      if (wanted(*guidance)) return *guidance;
    }
  }
  FAIL("no guidance within 20 s");
  return {};
}

std::filesystem::path WriteConfig(const std::filesystem::path& file, const std::string& yaml) {
  std::ofstream(file) << yaml;
  return file;
}

TEST_CASE("Killed between two pictures, the operator service goes on where it was",
          "[operator][integration]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const TemporaryFolder folder;
  OperatorConfig service_config = ConfigFor(folder / "operator.db");
  service_config.bus = test::OnLoopback(vendor);
  SimulatedOperatorConfig person_config;
  person_config.bus = test::OnLoopback(vendor);
  const auto service_file =
      WriteConfig(folder / "operator.yaml", DumpConfig("operator", service_config));
  const auto person_file =
      WriteConfig(folder / "person.yaml", DumpConfig("simulated_operator", person_config));

  HandMadeSim sim(test::OnLoopback(vendor));
  sim.Begin();
  test::ServiceProcess service("conav-operator", service_file);
  test::ServiceProcess person("conav-simulated-operator", person_file);
  const Guidance first = WaitForGuidance(sim, [](const Guidance&) { return true; });
  CHECK(first.path.size() == 4);
  CHECK(service.End(SIGKILL).signal == SIGKILL);

  Snapshot snapshot = SnapshotOf(1);
  snapshot.visible.walls.clear();
  REQUIRE(sim.snapshot.Publish(ToMessage(snapshot)));  // nobody there to store an answer

  test::ServiceProcess again("conav-operator", service_file);
  const Guidance answer =
      WaitForGuidance(sim, [](const Guidance& g) { return g.answers_snapshot == 1; });
  CHECK(answer.revision == first.revision + 1);
  CHECK(again.End(SIGTERM).exit_code == 0);
  CHECK(person.End(SIGINT).exit_code == 0);
}

}  // namespace
}  // namespace conav::operators
