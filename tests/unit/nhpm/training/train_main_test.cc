#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/weights_file.h"
#include "support/child_process.h"
#include "support/program_runner.h"

namespace conav::nhpm {
namespace {

using Outcome = test::ProgramOutcome;

/// A camera in the middle of the map that sees the cell to the east; the person copies what it shows.
Segment SmallSegment(Random& random) {
  Segment segment;
  PerceptionQuery& query = segment.query;
  query.belief = BeliefGrid(7, 7, 1.0F);
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    if (query.belief.OnBorder(query.belief.CellAt(i))) continue;
    query.belief.values()[i] = random.Chance(0.3) ? 1.0F : 0.0F;
  }
  query.cell = {3, 3};
  query.path = query.visible.free = {query.cell};
  query.belief[query.cell] = 0.0F;
  const Cell seen{3, 4};
  const bool wall = random.Chance(0.5);
  (wall ? query.visible.walls : query.visible.free).push_back(seen);
  segment.belief_after = query.belief;
  segment.belief_after[seen] = wall ? 1.0F : 0.0F;
  return segment;
}

/// Trajectories of two participants in turn.
SegmentSet SmallSet(int trajectories, std::uint64_t seed = 3) {
  Random random(seed);
  SegmentSet set;
  for (int i = 0; i < trajectories; ++i) {
    Trajectory trajectory;
    trajectory.origin = SegmentOrigin::kSynthetic;
    trajectory.participant = i % 2 == 0 ? "anna" : "bert";
    trajectory.session = std::to_string(i);
    trajectory.world = "test";
    for (std::uint32_t step = 0; step < 5; ++step) {
      trajectory.segments.push_back(SmallSegment(random));
      trajectory.segments.back().step = step;
    }
    set.trajectories.push_back(trajectory);
  }
  return set;
}

/// A folder with ten trajectories to train on as "d", and conav-train run there.
struct TrainBench : test::ProgramRunner {
  TrainBench() : ProgramRunner("conav-train") { Write("d", SmallSet(10)); }

  void Write(const char* name, const SegmentSet& set) const {
    REQUIRE(WriteSegmentFile(*this / name, set));
  }
  /// A small training; `flags` begin with the weights to write.
  Outcome Train(const std::string& flags) const { return Run(kSmall + flags); }
  /// The same, to be killed: its output in one small pipe, so that it cannot be far ahead of what was
  /// read of it.
  test::ChildProcess Start(const std::string& flags) const {
    return test::ChildProcess(fmt::format("cd '{}' && exec '{}/conav-train' {} 2>&1",
                                          (*this / ".").string(), CONAV_BIN_DIR, kSmall + flags),
                              4096);
  }
  bool Has(const char* name) const { return std::filesystem::exists(*this / name); }
  std::string Bytes(const char* name) const { return ReadFile(*this / name).value(); }
  nlohmann::json Json(const char* name) const { return nlohmann::json::parse(Bytes(name)); }
  NetworkModel Weights(const char* name) const { return ReadWeightsFile(*this / name).value(); }

  static inline const std::string kSmall = "--data d --width 16 --batch 16 --patience 0 --out ";
};

TEST_CASE("conav-train writes weights, a curve and figures", "[train]") {
  const TrainBench bench;
  const Outcome outcome = bench.Train("w.nhpm --epochs 3 --seed 5 --json w.json");
  INFO(outcome.text());
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel model = bench.Weights("w.nhpm");
  CHECK(model.weights.shape.width == 16);
  CHECK(model.rows == 7);
  CHECK(model.data_origin == "synthetic");
  CHECK(model.training.at("seed") == "5");
  CHECK(model.training.at("epochs_done") == "3");
  CHECK(model.training.at("data_sha256") == Sha256Hex(bench.Bytes("d")));
  CHECK_THAT(bench.Bytes("w.nhpm.svg"), Catch::StartsWith("<svg"));
  const auto json = bench.Json("w.json");
  CHECK(json["checksum"] == ChecksumOf(model));
  CHECK(json["epochs"].size() == 3);
  CHECK(json["epochs"][1]["epoch"] == 2);
  CHECK(json["validation_mbce"].get<double>() > 0.0);
  CHECK(json["test_mbce"].get<double>() > 0.0);
  CHECK(json["training"]["split_seed"] == "1");
  CHECK_FALSE(bench.Has("w.nhpm.checkpoint"));
  CHECK_THAT(outcome.text(), Catch::Contains("epoch   3/3") && Catch::Contains(ChecksumOf(model)));
}

TEST_CASE("conav-train sweeps over options, does each training once, and keeps the best weights",
          "[train]") {
  const TrainBench bench;
  const std::string flags = "best --epochs 2 --sweep seed=1..2 --sweep batch=8,16 --json s.json";
  const std::string small = "--data d --width 16 --patience 0 --records swept --out ";
  CHECK(bench.Run(small + flags + " --piece 2").exit_code == 0);
  CHECK_FALSE(bench.Has("best"));
  const auto second = std::filesystem::last_write_time(bench / "swept/pieces/2.json");
  const Outcome outcome = bench.Run(small + flags);
  INFO(outcome.text());
  REQUIRE(outcome.exit_code == 0);
  CHECK(std::filesystem::last_write_time(bench / "swept/pieces/2.json") == second);
  const auto json = bench.Json("s.json");
  REQUIRE(json["trainings"].size() == 4);
  CHECK(json["trainings"][2]["name"] == "seed=2 batch=8");
  const auto best = std::ranges::min_element(json["trainings"], {}, [](const auto& training) {
    return training["validation_mbce"].template get<double>();
  });
  CHECK(json["best"] == (*best)["name"]);
  CHECK((bench.Bytes("best") == bench.Bytes((*best)["weights"].get<std::string>().c_str())));
  CHECK_THAT(outcome.text(), Catch::Contains("batch=16") && Catch::Contains("best: seed="));
  CHECK(bench.Run(small + "best --sweep seed=1..3").exit_code == 2);  // another command's records
  for (const char* wrong : {"a --sweep seed=", "b --sweep nothing=1", "c --sweep seed", "d"}) {
    CHECK(bench.Run("--data d --out w --records " + std::string(wrong)).exit_code == 2);
  }
}

TEST_CASE("conav-train that was killed goes on and ends with the same bytes", "[train]") {
  const TrainBench bench;
  REQUIRE(bench.Train("whole --epochs 300").exit_code == 0);
  for (const char* line : {"epoch   2/300", "epoch  40/300"}) {
    test::ChildProcess program = bench.Start("killed --epochs 300");
    REQUIRE(program.ReadUntil(line));
    program.Signal(SIGKILL);
    REQUIRE(program.Wait() == 128 + SIGKILL);
    REQUIRE_FALSE(bench.Has("killed"));
  }
  const Outcome outcome = bench.Train("killed --epochs 300");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.text(), Catch::Contains("resuming from killed.checkpoint"));
  CHECK((bench.Bytes("killed") == bench.Bytes("whole")));
}

TEST_CASE("conav-train trains an encoder-decoder, whose probabilities are without the class weight",
          "[train]") {
  const TrainBench bench;
  const std::string flags =
      "--model encoder-decoder --width 4 --canvas 32 --data d --batch 8 --epochs 2 ";
  const Outcome outcome = bench.Run(flags + "--out whole");
  INFO(outcome.text());
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel model = bench.Weights("whole");
  CHECK(model.name == "encoder-decoder");
  CHECK(model.rows == 0);
  CHECK(model.training.at("class_weight") == "338");
  CHECK(model.weights.biases.back()[0] < -2.0F);  // it began at log(338 * edits / others) > 0
  REQUIRE(bench.Run(flags + "--limit-s 1e-9 --out part").exit_code == 0);
  CHECK(bench.Weights("part").training.at("stopped") == "time limit");
  REQUIRE(bench.Run(flags + "--out part").exit_code == 0);
  CHECK((bench.Bytes("part") == bench.Bytes("whole")));
  const Outcome adapted = bench.Run("--data d --out w --adapt --participant anna --base whole");
  CHECK(adapted.exit_code == 1);
  CHECK_THAT(adapted.error, Catch::Contains("whole: is an encoder-decoder"));
}

TEST_CASE("conav-train stops on SIGINT, says so and keeps its checkpoint", "[train]") {
  const TrainBench bench;
  test::ChildProcess program = bench.Start("w --epochs 1000000");
  REQUIRE(program.ReadUntil("epoch   2/1000000"));
  program.Signal(SIGINT);
  CHECK(program.Wait() == 1);
  CHECK_THAT(program.text(), Catch::Contains("stopped after epoch"));
  CHECK(bench.Has("w.checkpoint"));
  CHECK_FALSE(bench.Has("w"));
}

TEST_CASE("conav-train refuses a checkpoint that is damaged or of another training", "[train]") {
  const TrainBench bench;
  {
    test::ChildProcess program = bench.Start("w --epochs 1000000");
    REQUIRE(program.ReadUntil("epoch   2/"));
    program.Kill();
  }
  const Outcome refused = bench.Train("w --epochs 2 --seed 2 --without tau");
  CHECK(refused.exit_code == 1);
  for (const char* part : {"epochs 1000000", "inputs x,tau,o", "seed 1", "--fresh"}) {
    CHECK_THAT(refused.error, Catch::Contains(part));
  }
  REQUIRE(WriteFile(bench / "w.checkpoint", "CNVC and then something else"));
  const Outcome damaged = bench.Train("w --epochs 1");
  CHECK(damaged.exit_code == 1);
  CHECK_THAT(damaged.error, Catch::Contains("w.checkpoint: ") && Catch::Contains("--fresh"));
  CHECK(bench.Train("w --epochs 2 --seed 2 --fresh").exit_code == 0);
}

TEST_CASE("The weights say which inputs were left out and from which trajectories they learned",
          "[train]") {
  const TrainBench bench;
  REQUIRE(bench.Train("w --epochs 1 --without tau,o --view-encoding mask --any-size --split-seed 4")
              .exit_code == 0);
  const NetworkModel model = bench.Weights("w");
  CHECK(model.inputs ==
        InputSelection{.belief = true, .path = false, .view = false, .depth = false});
  CHECK(model.rows == 0);
  const SegmentSplit split = SplitSegments(SmallSet(10), 4);
  CHECK(model.learned_from.size() == 9);
  CHECK(CountKnown(split.train, model.learned_from) == 8);
  CHECK(CountKnown(split.validation, model.learned_from) == 1);
  CHECK(CountKnown(split.test, model.learned_from) == 0);
}

TEST_CASE("conav-train names data that it cannot use", "[train]") {
  const TrainBench bench;
  for (const auto& [trajectories, names] :
       {std::pair(0, "d: has no segments"), std::pair(2, "has 2 trajectories")}) {
    bench.Write("d", SmallSet(trajectories));
    const Outcome outcome = bench.Train("w --epochs 1");
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.error, Catch::Contains(names));
    CHECK_FALSE(bench.Has("w"));
  }
}

TEST_CASE("conav-train ends with 2 for options that are wrong or would write over a file",
          "[train]") {
  const TrainBench bench;
  const std::string before = bench.Bytes("d");
  for (const std::string flags : {"d",
                                  "w --json w",
                                  "w --json d",
                                  "w --svg x/../w",
                                  "w --json w.checkpoint",
                                  "/nonexistent/w",
                                  "w --width 48",
                                  "w --without z",
                                  "w --without tau,o,x",
                                  "w --epochs 0",
                                  "w --threads 0",
                                  "w --learning-rate -1",
                                  "w --learning-rate 0",
                                  "w --learning-rate nan",
                                  "w --seed -1",
                                  "w --split-seed -1",
                                  "w --adapt",
                                  "w --base b",
                                  "w --participant p",
                                  "w --adapt --base b --view-encoding mask",
                                  "w --view-encoding blurred",
                                  "w --class-weight 0",
                                  "w --width 4",
                                  "w --canvas 100",
                                  "w --model glpf",
                                  "w --model encoder-decoder --width 64",
                                  "w --model encoder-decoder --without o",
                                  "w --model encoder-decoder --view-encoding mask",
                                  "w --adapt --base b --model encoder-decoder",
                                  "w --adapt --base b --epochs 3"}) {
    INFO(flags);
    CHECK(bench.Run("--data d --out " + flags).exit_code == 2);
  }
  CHECK((bench.Bytes("d") == before));
  CHECK_FALSE(bench.Has("w"));
}

TEST_CASE("conav-train keeps finished weights of another training, unless --overwrite is given",
          "[train]") {
  const TrainBench bench;
  REQUIRE(bench.Train("w --epochs 1").exit_code == 0);
  const std::string first = bench.Bytes("w");
  CHECK(bench.Train("w --epochs 1").exit_code == 0);
  const Outcome refused = bench.Train("w --epochs 1 --seed 2");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.error,
             Catch::Contains("seed 1 there, 2 now") && Catch::Contains("--overwrite"));
  CHECK((bench.Bytes("w") == first));
  CHECK(bench.Train("w --epochs 1 --seed 2 --overwrite").exit_code == 0);
  CHECK_FALSE((bench.Bytes("w") == first));
  REQUIRE(WriteFile(bench / "notes", "no weights"));
  CHECK_THAT(bench.Train("notes --epochs 1").error, Catch::Contains("--overwrite"));
}

TEST_CASE("conav-train does not train for a device", "[train]") {
  const TrainBench bench;
  CHECK(bench.Run("--data d --out /dev/null --no-svg --epochs 1000000").exit_code == 1);
  CHECK_FALSE(std::filesystem::exists("/dev/null.checkpoint"));
}

TEST_CASE("conav-train adapts to one participant and names what the weights learned from",
          "[adapt]") {
  const TrainBench bench;
  REQUIRE(bench.Train("base --epochs 20").exit_code == 0);
  const std::string flags = "--data d --adapt --base base --participant ";
  const Outcome outcome = bench.Run(flags + "anna --out anna");
  INFO(outcome.text());
  REQUIRE(outcome.exit_code == 0);
  NetworkModel base = bench.Weights("base");
  const NetworkModel anna = bench.Weights("anna");
  CHECK(anna.training.at("base_checksum") == ChecksumOf(base));
  CHECK(anna.training.at("adapt_participant") == "anna");
  CHECK(anna.training.at("adapt_segments") == "25");
  CHECK(std::stod(anna.training.at("adapt_held_out_mbce")) <
        std::stod(anna.training.at("adapt_base_mbce")));
  REQUIRE(bench.Run(flags + "bert --out bert").exit_code == 0);
  const Fingerprints bert = bench.Weights("bert").learned_from;
  CHECK(base.learned_from.size() == 9);
  CHECK(bert.size() == 10);  // with the one that the base was tested on
  CHECK(Union(base.learned_from, bert) == bert);
  base.learned_from.clear();
  REQUIRE(WriteWeightsFile(bench / "base", base));
  REQUIRE(bench.Run(flags + "bert --overwrite --out bert").exit_code == 0);
  CHECK(bench.Weights("bert").learned_from.empty());
}

TEST_CASE("conav-train names what it cannot adapt", "[adapt]") {
  const TrainBench bench;
  NetworkModel model;
  model.weights = InitialWeights({16}, 1);
  REQUIRE(WriteWeightsFile(bench / "base", model));
  model.rows = model.columns = 13;
  REQUIRE(WriteWeightsFile(bench / "large", model));
  for (const auto& [adapt, named] :
       {std::pair("d --participant anna", ": d: "), std::pair("base --participant carl", "'carl'"),
        std::pair("large --participant anna", "13 x 13")}) {
    const Outcome outcome = bench.Run(std::string("--data d --out w --adapt --base ") + adapt);
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.error, Catch::Contains(named));
  }
}

}  // namespace
}  // namespace conav::nhpm
