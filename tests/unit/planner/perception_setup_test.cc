#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/runtime/log.h"
#include "conformance/perception_model_conformance.h"
#include "nhpm/model/glpf.h"
#include "nhpm/model/perception_network.h"
#include "planner/planner_service.h"
#include "support/test_weights.h"

namespace conav::planner {
namespace {

using conformance::MakeQuery;

struct Bench {
  Bench() {
    config.perception = "embedded";
    config.perception_model = PerceptionModelKind::kNhpm;
    log::SetSink([this](const log::Record& record) { lines.emplace_back(record.text); });
  }
  ~Bench() { log::SetSink(nullptr); }

  PerceptionSetup Make() { return PerceptionSetup(participant, config, clock); }
  int Lines(const std::string& text) const {
    return static_cast<int>(std::count_if(lines.begin(), lines.end(), [&](const auto& line) {
      return line.find(text) != std::string::npos;
    }));
  }

  test::WeightsFolder folder;
  PlannerConfig config;
  FakeClock clock;
  bus::Participant participant{"planner", std::make_shared<bus::InMemoryBus>()};
  std::vector<std::string> lines;
};

TEST_CASE("An embedded network answers with its own bits and says its checksum",
          "[planner][perception]") {
  Bench bench;
  const nhpm::NetworkModel network = test::UntrainedNetwork(3);
  bench.config.weights = bench.folder.Write("own", network);
  const auto model = bench.Make().ForWorld("w1");
  const std::vector queries{MakeQuery(1)};
  CHECK(*model->Predict(queries) == *nhpm::PerceptionNetwork(network).Predict(queries));
  CHECK(model->identity().name == "nhpm");
  CHECK(bench.Lines(nhpm::ChecksumOf(network)) == 1);
}

TEST_CASE("On a grid that the network was not made for the GLPF answers, in that world only",
          "[planner][perception]") {
  Bench bench;
  bench.config.weights = bench.folder.Write("own", test::UntrainedNetwork(3, 13, 13));
  const PerceptionSetup perception = bench.Make();
  const auto fitting = perception.ForWorld("w1");
  const auto other = perception.ForWorld("w2");
  const std::vector large{MakeQuery(1, 13, 13)};
  const std::vector small{MakeQuery(1, 9, 11)};
  REQUIRE(fitting->Predict(large));
  CHECK(*other->Predict(small) == *nhpm::Glpf().Predict(small));
  CHECK(other->identity().name == "fallback: glpf");
  CHECK(fitting->identity().name == "nhpm");
  CHECK(bench.Lines("world=w2") == 1);
  CHECK(bench.Lines("13 x 13") == 1);
}

TEST_CASE("The shipped encoder-decoder answers on a raster of 150 x 150 cells",
          "[planner][perception]") {
  Bench bench;
  bench.config.perception_model = PerceptionModelKind::kEncoderDecoder;
  PerceptionQuery query;
  query.belief = BeliefGrid(150, 150, 0.0F);
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    const Cell cell = query.belief.CellAt(i);
    const bool land = query.belief.OnBorder(cell) || cell.row < 60 || cell.row > 90;
    const bool silted = cell.column >= 85 && cell.column < 95;  // the robot sees that it is not
    if (land || silted) query.belief[cell] = 1.0F;
  }
  query.cell = {75, 70};
  for (int row = 70; row < 80; ++row) {
    for (int column = 40; column <= 75; ++column) query.path.push_back({row, column});
  }
  for (int row = 61; row < 90; ++row) {
    for (int column = 75; column < 115; ++column) query.visible.free.push_back({row, column});
  }
  const auto model = bench.Make().ForWorld("w1");
  const auto answers = model->Predict({&query, 1});
  REQUIRE(answers);
  CHECK(model->identity().name == "encoder-decoder");
  const auto removed = [&](int first_row, int last_row) {
    double sum = 0.0;
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = 85; column < 95; ++column) {
        sum += static_cast<double>(answers->front().remove[{row, column}]);
      }
    }
    return sum / (10.0 * (last_row - first_row + 1));
  };
  CHECK(removed(70, 80) > 10.0 * removed(10, 40));
}

TEST_CASE("The GLPF answers where it is embedded, and where nobody else does",
          "[planner][perception]") {
  const bool remote = GENERATE(true, false);
  Bench bench;
  bench.config.perception = remote ? "remote" : "embedded";
  bench.config.perception_timeout_s = 0.01;
  if (!remote) bench.config.perception_model = PerceptionModelKind::kGlpf;
  bench.config.weights = remote ? "" : "/nowhere/a.nhpm";
  const auto model = bench.Make().ForWorld("w1");
  const std::vector queries{MakeQuery(1)};
  CHECK(*model->Predict(queries) == *nhpm::Glpf().Predict(queries));
  CHECK(model->identity().name == (remote ? "fallback: glpf" : "glpf"));
}

TEST_CASE("Weights that an embedded network does not find stop the start",
          "[planner][perception]") {
  Bench bench;
  bench.config.weights = "/nowhere/a.nhpm";
  CHECK_THROWS_WITH(bench.Make(),
                    Catch::Contains("planner.weights: ") && Catch::Contains("/nowhere/a.nhpm"));
}

TEST_CASE("A person, a checksum or a belief that cannot be is refused by the config",
          "[planner][perception]") {
  const auto read = [](const std::string& yaml) {
    PlannerConfig config;
    ReadConfig(YAML::Load(yaml), "planner", config);
  };
  CHECK_NOTHROW(read("{person: anna}"));
  CHECK_THROWS_WITH(read("{person: ../anna}"), Catch::Contains("planner.person"));
  CHECK_THROWS_WITH(read("{perception_checksum: abc}"), Catch::Contains("perception_checksum"));
  CHECK_THROWS_WITH(read("{x_source: guessed}"), Catch::Contains("x_source"));
}

}  // namespace
}  // namespace conav::planner
