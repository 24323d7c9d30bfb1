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
#include "support/wait.h"

namespace conav::operators {
namespace {

/// Guidance for r1 that `wanted` accepts, waited for.
Guidance WaitForGuidance(HandMadeSim& sim, const std::function<bool(const Guidance&)>& wanted) {
  Guidance found;
  REQUIRE(test::WaitUntil(
      [&] {
        for (const auto& message : sim.guidance.Take()) {
          found = ToDomain(message).value();
          if (wanted(found)) return true;
        }
        return false;
      },
      std::chrono::seconds(20)));
  return found;
}

TEST_CASE("Killed between two pictures, the operator service goes on where it was",
          "[operator][integration]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const TemporaryFolder folder;
  OperatorConfig service_config = ConfigFor(folder / "operator.db");
  service_config.bus = test::OnLoopback(vendor);
  SimulatedOperatorConfig person_config;
  person_config.bus = test::OnLoopback(vendor);
  std::ofstream(folder / "operator.yaml") << DumpConfig("operator", service_config);
  std::ofstream(folder / "person.yaml") << DumpConfig("simulated_operator", person_config);

  HandMadeSim sim(test::OnLoopback(vendor));
  sim.Begin();
  test::ServiceProcess service("conav-operator", folder / "operator.yaml");
  test::ServiceProcess person("conav-simulated-operator", folder / "person.yaml");
  const Guidance first = WaitForGuidance(sim, [](const Guidance&) { return true; });
  CHECK(first.path.size() == 4);
  CHECK(service.End(SIGKILL).signal == SIGKILL);

  Snapshot snapshot = SnapshotOf(1);
  snapshot.visible.walls.clear();
  REQUIRE(sim.snapshot.Publish(ToMessage(snapshot)));  // nobody there to store an answer

  test::ServiceProcess again("conav-operator", folder / "operator.yaml");
  const Guidance answer =
      WaitForGuidance(sim, [](const Guidance& g) { return g.answers_snapshot == 1; });
  CHECK(answer.revision == first.revision + 1);
  CHECK(again.End(SIGTERM).exit_code == 0);
  CHECK(person.End(SIGINT).exit_code == 0);
}

}  // namespace
}  // namespace conav::operators
