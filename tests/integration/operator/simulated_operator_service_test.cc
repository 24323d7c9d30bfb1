#include "operator/simulated/simulated_operator_service.h"

#include "integration/operator/operator_bench.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

SimulatedOperatorConfig Careful() {
  SimulatedOperatorConfig config;
  config.person.reader = {.edit_probability = 1.0,
                          .decay_cells = 1e6,
                          .misplacement_probability = 0.0,
                          .lapse_probability = 0.0,
                          .guess_probability = 0.0};
  return config;
}

/// Operator service and simulated operator next to a hand-made simulator.
struct PersonBench : OperatorBench {
  /// Until nobody has anything more to say.
  void SettleBoth() {
    for (int i = 0; i < 10; ++i) {
      service.Step();
      person.Step();
      clock.Advance(100ms);
    }
  }

  bus::Participant person_participant{"simulated_operator", bus};
  SimulatedOperatorService person{person_participant, Careful(), clock};
};

TEST_CASE("A snapshot leads to an edit and to guidance that answers it, a blocked robot as well",
          "[operator][integration]") {
  PersonBench bench;
  bench.sim.Begin();
  bench.SettleBoth();
  Guidance guidance = bench.sim.NewestGuidance();
  CHECK(guidance.path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}, {1, 4}});
  CHECK(guidance.revision == 1);
  CHECK(guidance.answers_snapshot == 0);
  CHECK(guidance.given_by.rfind("synthetic-operator-", 0) == 0);

  REQUIRE(bench.sim.snapshot.Publish(ToMessage(SnapshotOf(1))));
  bench.sim.PublishState({1, 1}, 10, 1);
  bench.SettleBoth();
  const Belief belief = bench.sim.NewestBelief();
  CHECK(belief.revision == 1);
  CHECK(belief.wall_probability[{1, 3}] == 1.0F);
  guidance = bench.sim.NewestGuidance();
  CHECK(guidance.revision == 2);
  CHECK(guidance.answers_snapshot == 1);
  CHECK(guidance.belief_revision == 1);
  CHECK(guidance.path.size() == 8);  // around the new wall
  const AttentionRequest blocked{{5}, "w1", "r1", 1, AttentionReason::kBlocked, {2, 1}, 0, 0, 0};
  REQUIRE(bench.sim.attention.Publish(ToMessage(blocked)));
  bench.SettleBoth();
  CHECK(bench.sim.NewestBelief().wall_probability[{2, 1}] == 1.0F);
  CHECK(bench.sim.NewestGuidance().path.at(1) == Cell{1, 2});
  CHECK(bench.person.person().open() == 0);
}

TEST_CASE("After all goals the simulated operator asks for nothing more",
          "[operator][integration]") {
  PersonBench bench;
  bench.sim.Begin();
  bench.SettleBoth();
  REQUIRE(bench.sim.guidance.Take().size() == 1);
  bench.sim.goals_left.clear();
  bench.sim.PublishState({1, 4}, 20, 1);
  REQUIRE(bench.sim.snapshot.Publish(ToMessage(SnapshotOf(1))));
  bench.SettleBoth();
  CHECK(bench.sim.guidance.Take().empty());
  CHECK(bench.sim.NewestBelief().revision == 0);
}

TEST_CASE("Once somebody else guides the simulated operator stands aside",
          "[operator][integration]") {
  PersonBench bench;
  bench.sim.Begin();
  bench.SettleBoth();
  bench.client.Send("w1", GuideRequest{"r1", {{1, 1}, {1, 2}}, 0, 60.0}, {});
  bench.SettleBoth();
  REQUIRE(bench.sim.NewestGuidance().given_by == "anna");
  REQUIRE(bench.sim.snapshot.Publish(ToMessage(SnapshotOf(1))));
  bench.sim.PublishState({1, 1}, 10, 1);
  bench.SettleBoth();
  CHECK(bench.sim.guidance.Take().empty());
  CHECK(bench.sim.NewestBelief().revision == 0);
  CHECK(bench.person.person().open() == 0);  // it keeps nothing
}

TEST_CASE("While all robots are stopped the simulated operator asks for nothing",
          "[operator][integration]") {
  PersonBench bench;
  bus::Publisher<conav_msgs::msg::StopOrder> stops(bench.sim.participant, bus::kStopOrder, "r1");
  const auto publish = [&](std::uint64_t revision, bool stopped) {
    REQUIRE(stops.Publish(
        ToMessage(StopOrder{{5}, "w1", "r1", revision, stopped, "anna", "wait for me"})));
  };
  publish(1, true);
  bench.sim.Begin();
  bench.SettleBoth();
  CHECK(bench.sim.guidance.Take().empty());
  publish(2, false);
  bench.SettleBoth();
  CHECK(bench.sim.NewestGuidance().path.size() == 4);
}

}  // namespace
}  // namespace conav::operators
