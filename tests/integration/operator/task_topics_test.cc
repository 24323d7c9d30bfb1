#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "integration/operator/hand_made_sim.h"
#include "operator/console/console_topics.h"

namespace conav::operators {
namespace {

/// Two walls are missing.
const std::vector<std::string> kBareMap = {"######", "#    #", "#    #", "#    #", "######"};

struct TaskBench {
  TaskBench() {
    config = ConfigFor(folder / "operator.db");
    config.task.kind = "mapping";
    config.task.participant = "P07";
    config.task.result = (folder / "result.json").string();
    REQUIRE(truth.Publish(ToMessage(MapUpdate{{0}, 1.5, DrawnTruth(kMap)})));
  }

  /// The topics as the service has them, before the participant begins.
  void Start() {
    topics.reset();
    store.emplace(BeliefStoreOptions{{config.database, 0}, {}});
    topics.emplace(participant, config, *store, clock);
    REQUIRE(store->AddWorld("w1", ToBelief(DrawnTruth(kBareMap)), {}));
    topics->Step();
  }
  void Begin() { topics->Receive(ControlRegistry({{"r1", "w1"}}, {.start_stopped = false})); }
  void ReachAllGoals() {
    if (topics->status().phase == TaskPhase::kWaiting) Begin();
    topics->Receive(RobotState{.robot = "r1", .goals_total = 4, .snapshots = 6});
  }
  void Correct() {
    const OperatorRequest request{
        {}, "page", 1, std::string("w1"), EditRequest{0, {{{2, 2}, true}}}};
    REQUIRE(store->Handle(request, {}).reply.accepted);
  }
  BeliefStore::Answer Finish(std::uint64_t id = 9) {
    return topics->Finish({{}, "page", id, {}, FinishRequest{}});
  }
  nlohmann::json Result() const {
    return nlohmann::json::parse(ReadFile(folder / "result.json").value_or("null"));
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant sim{"sim", bus};
  bus::Publisher<nav_msgs::msg::OccupancyGrid> truth{sim, bus::kTruth, "w1"};
  bus::Participant participant{"operator", bus};
  FakeClock clock;
  OperatorConfig config;
  std::optional<BeliefStore> store;
  std::optional<TaskTopics> topics;
};

}  // namespace

TEST_CASE("a finished maze's result is on disk when it is acknowledged, and stays so",
          "[operator][task]") {
  TaskBench bench;
  bench.Start();
  bench.Correct();
  CHECK_FALSE(bench.Finish().reply.accepted);
  CHECK(bench.Result().is_null());
  bench.ReachAllGoals();
  CHECK(bench.topics->status().may_finish);
  const auto answer = bench.Finish(10);
  CHECK(answer.reply.accepted);
  CHECK(answer.changed);
  CHECK(bench.topics->status().mapping_accuracy == 0.5);
  const auto result = bench.Result();
  CHECK(result["participant"] == "P07");
  CHECK(result["mapping_accuracy"] == 0.5);
  CHECK(result["edits"] == 1);
  CHECK(result["pictures"] == 6);
  const auto repeat = bench.Finish(10);
  CHECK(repeat.reply.accepted);
  CHECK_FALSE(repeat.changed);
  CHECK_FALSE(bench.Finish(4).reply.accepted);
  bench.store.reset();
  bench.topics.reset();
  bench.store.emplace(BeliefStoreOptions{{bench.config.database, 0}, {}});
  bench.topics.emplace(bench.participant, bench.config, *bench.store, bench.clock);
  CHECK(bench.topics->status().phase == TaskPhase::kFinished);
  CHECK(bench.topics->status().mapping_accuracy == 0.5);
}

TEST_CASE("a result that cannot be written is not acknowledged", "[operator][task]") {
  TaskBench bench;
  const auto results = bench.folder / "results";
  std::filesystem::create_directory(results);
  bench.config.task.result = (results / "result.json").string();
  bench.Start();
  bench.ReachAllGoals();
  std::filesystem::remove(results);
  const auto answer = bench.Finish();
  CHECK_FALSE(answer.reply.accepted);
  CHECK_THAT(answer.reply.reason, Catch::Contains("results"));
  CHECK_FALSE(bench.topics->finished());
  std::filesystem::create_directory(results);
  CHECK(bench.Finish().reply.accepted);
}

TEST_CASE("a task of two worlds, or whose result could not be written, does not start",
          "[operator][task]") {
  TaskBench unwritable;
  unwritable.config.task.result = (unwritable.folder / "nowhere" / "result.json").string();
  CHECK_THROWS_WITH(unwritable.Start(),
                    Catch::Contains("operator.task.result") && Catch::Contains("nowhere"));
  TaskBench bench;
  bench.config.robots = {"w1/r1", "w2/r2"};
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("w1 and w2"));
  bench.config.robots = {"w1/r1"};
  std::ofstream(bench.folder / "result.json") << "something else";
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("result.json"));
}

TEST_CASE("a task begins when a robot is resumed", "[operator][task]") {
  TaskBench bench;
  bench.Start();
  ControlRegistry control({{"r1", "w1"}}, {.start_stopped = true});
  bench.topics->Receive(control);
  CHECK(bench.topics->status().phase == TaskPhase::kWaiting);
  const auto orders = control.Resume("page", {}, {});
  REQUIRE(orders);
  for (const StopOrder& order : *orders) control.Adopt(order);
  bench.topics->Receive(control);
  CHECK(bench.topics->status().phase == TaskPhase::kRunning);
}

}  // namespace conav::operators
