#include "unit/nhpm/training/train_program.h"

namespace conav::nhpm {
namespace {

TEST_CASE("conav-train writes weights, a curve and figures", "[train]") {
  const DataFolder folder;
  const Outcome outcome =
      Run(folder.Flags("w.nhpm") + "--epochs 3 --seed 5 --json " + (folder / "w.json"));
  INFO(outcome.text);
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel model = ReadWeightsFile(folder / "w.nhpm").value();
  CHECK(model.weights.shape.width == 16);
  CHECK(model.rows == 7);
  CHECK(model.data_origin == "synthetic");
  CHECK(model.training.at("seed") == "5");
  CHECK(model.training.at("epochs_done") == "3");
  CHECK(model.training.at("data_sha256") == Sha256Hex(ReadFile(folder.data).value()));
  CHECK_THAT(ReadFile(folder / "w.nhpm.svg").value(), Catch::StartsWith("<svg"));
  const auto json = nlohmann::json::parse(ReadFile(folder / "w.json").value());
  CHECK(json["checksum"] == ChecksumOf(model));
  CHECK(json["epochs"].size() == 3);
  CHECK(json["epochs"][1]["epoch"] == 2);
  CHECK(json["validation_mbce"].get<double>() > 0.0);
  CHECK(json["test_mbce"].get<double>() > 0.0);
  CHECK(json["training"]["split_seed"] == "1");
  CHECK_FALSE(Exists(folder / "w.nhpm.checkpoint"));
  CHECK_THAT(outcome.text, Catch::Contains("epoch   3/3") && Catch::Contains(ChecksumOf(model)));
}

TEST_CASE("conav-train that was killed goes on and ends with the same bytes", "[train]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("whole") + "--epochs 300").exit_code == 0);
  const std::string flags = folder.Flags("killed") + "--epochs 300";
  for (const char* line : {"epoch   2/300", "epoch  40/300"}) {
    Program program(flags);
    REQUIRE(program.ReadUntil(line));
    program.Signal(SIGKILL);
    REQUIRE(program.Wait() == 128 + SIGKILL);
    REQUIRE_FALSE(Exists(folder / "killed"));
  }
  const Outcome outcome = Run(flags);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.text, Catch::Contains("resuming from " + (folder / "killed.checkpoint")));
  CHECK((ReadFile(folder / "killed").value() == ReadFile(folder / "whole").value()));
}

TEST_CASE("conav-train stops on SIGINT, says so and keeps its checkpoint", "[train]") {
  const DataFolder folder;
  Program program(folder.Flags("w") + "--epochs 1000000");
  REQUIRE(program.ReadUntil("epoch   2/1000000"));
  program.Signal(SIGINT);
  CHECK(program.Wait() == 1);
  CHECK_THAT(program.text(), Catch::Contains("stopped after epoch") &&
                                 Catch::Contains("the same command resumes from"));
  CHECK(Exists(folder / "w.checkpoint"));
  CHECK_FALSE(Exists(folder / "w"));
}

TEST_CASE("conav-train refuses a checkpoint that is damaged or of another training", "[train]") {
  const DataFolder folder;
  {
    Program program(folder.Flags("w") + "--epochs 1000000");
    REQUIRE(program.ReadUntil("epoch   2/"));
    program.Signal(SIGKILL);
    program.Wait();
  }
  const Outcome refused = Run(folder.Flags("w") + "--epochs 2 --seed 2 --without tau");
  CHECK(refused.exit_code == 1);
  for (const char* part : {"epochs 1000000 there, 2 now", "inputs x,tau,o there, x,o now",
                           "seed 1 there, 2 now", "--fresh"}) {
    CHECK_THAT(refused.text, Catch::Contains(part));
  }
  REQUIRE(WriteFile(folder / "w.checkpoint", "CNVC and then something else"));
  const Outcome damaged = Run(folder.Flags("w") + "--epochs 1");
  CHECK(damaged.exit_code == 1);
  CHECK_THAT(damaged.text,
             Catch::Contains(folder / "w.checkpoint: ") && Catch::Contains("--fresh"));
  CHECK(Run(folder.Flags("w") + "--epochs 2 --seed 2 --fresh").exit_code == 0);
}

TEST_CASE("conav-train leaves inputs out and says so in the weights", "[train]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("w") + "--epochs 1 --without tau,o --any-size").exit_code == 0);
  const NetworkModel model = ReadWeightsFile(folder / "w").value();
  CHECK(model.inputs == InputSelection{.belief = true, .path = false, .view = false});
  CHECK(model.rows == 0);
}

TEST_CASE("conav-train names in the weights the trajectories that they learned from", "[train]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("w") + "--epochs 1 --split-seed 4").exit_code == 0);
  const SegmentSplit split = SplitSegments(SmallSet(10), 4);
  const Fingerprints learned_from = ReadWeightsFile(folder / "w").value().learned_from;
  CHECK(learned_from.size() == 9);
  CHECK(CountKnown(split.train, learned_from) == 8);
  CHECK(CountKnown(split.validation, learned_from) == 1);
  CHECK(CountKnown(split.test, learned_from) == 0);
}

TEST_CASE("conav-train names data that it cannot use", "[train]") {
  const DataFolder folder;
  const auto text_of = [&](const SegmentSet& set) {
    REQUIRE(WriteSegmentFile(folder / "data.pb.zst", set));
    const Outcome outcome = Run(folder.Flags("w") + "--epochs 1");
    CHECK(outcome.exit_code == 1);
    CHECK_FALSE(Exists(folder / "w"));
    return outcome.text;
  };
  CHECK_THAT(text_of({}), Catch::Contains("data.pb.zst: has no segments"));
  CHECK_THAT(text_of(SmallSet(2)), Catch::Contains("has 2 trajectories"));
}

TEST_CASE("conav-train neither writes over what it reads nor two outputs into one file",
          "[train]") {
  const DataFolder folder;
  const std::string& data = folder.data;
  const std::string before = ReadFile(data).value();
  for (const std::string& flags :
       {"--out " + data, "--out " + (folder / "w") + " --json " + (folder / "w"),
        "--out " + (folder / "w") + " --json " + data,
        "--out " + (folder / "w") + " --svg " + (folder / "x/../w"),
        "--out " + (folder / "w") + " --json " + (folder / "w.checkpoint"),
        std::string("--out /nonexistent/w")}) {
    INFO(flags);
    CHECK(Run("--data " + data + " --epochs 1 " + flags).exit_code == 2);
  }
  CHECK((ReadFile(data).value() == before));
  CHECK_FALSE(Exists(folder / "w"));
}

TEST_CASE("conav-train keeps finished weights of another training, unless --overwrite is given",
          "[train]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("w") + "--epochs 1").exit_code == 0);
  const std::string first = ReadFile(folder / "w").value();
  CHECK(Run(folder.Flags("w") + "--epochs 1").exit_code == 0);
  const Outcome refused = Run(folder.Flags("w") + "--epochs 1 --seed 2");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text,
             Catch::Contains("seed 1 there, 2 now") && Catch::Contains("--overwrite"));
  CHECK((ReadFile(folder / "w").value() == first));
  CHECK(Run(folder.Flags("w") + "--epochs 1 --seed 2 --overwrite").exit_code == 0);
  CHECK_FALSE((ReadFile(folder / "w").value() == first));
  REQUIRE(WriteFile(folder / "notes", "no weights"));
  CHECK_THAT(Run(folder.Flags("notes") + "--epochs 1").text,
             Catch::Contains("--overwrite replaces it"));
}

TEST_CASE("conav-train fails when its standard output is full", "[train]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 1").exit_code == 0);
  REQUIRE(WriteSegmentFile(folder / "new", SmallSet(10, 7, 4)));
  const std::string adapt = "--data " + (folder / "new") + " --adapt --base " + (folder / "base");
  for (const std::string& flags :
       {folder.Flags("w") + "--epochs 1", adapt + " --participant anna --out " + (folder / "p"),
        adapt + " --each"}) {
    for (const char* json : {"", " --json -"}) {
      INFO(flags << json);
      CHECK(Run(flags + json + " >/dev/full").exit_code == 1);
    }
  }
}

TEST_CASE("conav-train does not train for a device", "[train]") {
  const DataFolder folder;
  const Outcome outcome =
      Run("--data " + folder.data + " --out /dev/null --no-svg --epochs 1000000");
  CHECK(outcome.exit_code == 1);
  CHECK_FALSE(Exists("/dev/null.checkpoint"));
}

TEST_CASE("conav-train refuses options out of range and those that contradict each other",
          "[train]") {
  CHECK(Run("--out w").exit_code == 2);
  for (const char* flags :
       {"--width 48", "--without z", "--without tau,o,x", "--epochs 0", "--threads 0",
        "--learning-rate -1", "--learning-rate 0", "--learning-rate nan", "--learning-rate inf",
        "--seed -1", "--split-seed -1", "--adapt", "--base b", "--participant p",
        "--adapt --base b --each", "--adapt --base b --epochs 3"}) {
    INFO(flags);
    CHECK(Run(std::string("--data d --out w ") + flags).exit_code == 2);
  }
}

}  // namespace
}  // namespace conav::nhpm
