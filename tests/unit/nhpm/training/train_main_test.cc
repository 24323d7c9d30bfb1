#include <catch2/catch.hpp>
#include <csignal>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/weights_file.h"
#include "support/child_process.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

using Folder = test::ArgumentFolder;

/// conav-train as a process of its own, its standard output and error in one small pipe: it cannot be
/// far ahead of what was read of it.
struct Program : test::ChildProcess {
  explicit Program(const std::string& arguments)
      : ChildProcess("exec " CONAV_BIN_DIR "/conav-train " + arguments + " 2>&1", 4096) {}
};

struct Outcome {
  int exit_code = -1;
  std::string text;
};

Outcome Run(const std::string& arguments) {
  Program program(arguments);
  const int code = program.Wait();
  return {code, program.text()};
}

/// A camera in the middle of the map that sees the cell to the east; the person copies what it shows.
Segment SmallSegment(int side, Random& random) {
  Segment segment;
  segment.query.belief = BeliefGrid(side, side, 1.0F);
  for (int row = 1; row < side - 1; ++row) {
    for (int column = 1; column < side - 1; ++column) {
      segment.query.belief[{row, column}] = random.Chance(0.3) ? 1.0F : 0.0F;
    }
  }
  const Cell camera{side / 2, side / 2};
  const Cell seen = camera + Cell{0, 1};
  const bool wall = random.Chance(0.5);
  segment.query.belief[camera] = 0.0F;
  segment.query.path = {camera};
  segment.query.cell = camera;
  segment.query.visible.free = {camera};
  (wall ? segment.query.visible.walls : segment.query.visible.free).push_back(seen);
  segment.belief_after = segment.query.belief;
  segment.belief_after[seen] = wall ? 1.0F : 0.0F;
  return segment;
}

/// Trajectories of two participants in turn.
SegmentSet SmallSet(int trajectories, int side = 7, std::uint64_t seed = 3) {
  Random random(seed);
  SegmentSet set;
  for (int i = 0; i < trajectories; ++i) {
    Trajectory trajectory;
    trajectory.origin = SegmentOrigin::kSynthetic;
    trajectory.participant = i % 2 == 0 ? "anna" : "bert";
    trajectory.session = std::to_string(i);
    trajectory.world = "test";
    for (std::uint32_t step = 0; step < 5; ++step) {
      trajectory.segments.push_back(SmallSegment(side, random));
      trajectory.segments.back().step = step;
    }
    set.trajectories.push_back(trajectory);
  }
  return set;
}

/// A folder with ten trajectories to train on.
struct DataFolder : Folder {
  DataFolder() { REQUIRE(WriteSegmentFile(data, SmallSet(10))); }
  /// Of a small training that writes the weights `out`.
  std::string Flags(const std::string& out) const {
    return "--data " + data + " --out " + (*this / out) + " --width 16 --batch 16 --patience 0 ";
  }
  const std::string data = *this / "data.pb.zst";
};

bool Exists(const std::string& path) { return std::filesystem::exists(path); }

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
  for (const char* part : {"epochs 1000000", "inputs x,tau,o", "seed 1", "--fresh"}) {
    CHECK_THAT(refused.text, Catch::Contains(part));
  }
  REQUIRE(WriteFile(folder / "w.checkpoint", "CNVC and then something else"));
  const Outcome damaged = Run(folder.Flags("w") + "--epochs 1");
  CHECK(damaged.exit_code == 1);
  CHECK_THAT(damaged.text,
             Catch::Contains(folder / "w.checkpoint: ") && Catch::Contains("--fresh"));
  CHECK(Run(folder.Flags("w") + "--epochs 2 --seed 2 --fresh").exit_code == 0);
}

TEST_CASE("The weights say which inputs were left out and from which trajectories they learned",
          "[train]") {
  const DataFolder folder;
  const char* flags = "--epochs 1 --without tau,o --any-size --split-seed 4";
  REQUIRE(Run(folder.Flags("w") + flags).exit_code == 0);
  const NetworkModel model = ReadWeightsFile(folder / "w").value();
  CHECK(model.inputs == InputSelection{.belief = true, .path = false, .view = false});
  CHECK(model.rows == 0);
  const SegmentSplit split = SplitSegments(SmallSet(10), 4);
  const Fingerprints& learned_from = model.learned_from;
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

TEST_CASE("conav-train ends with 2 for options that are wrong or would write over a file",
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
  for (const char* flags :
       {"--width 48", "--without z", "--without tau,o,x", "--epochs 0", "--threads 0",
        "--learning-rate -1", "--learning-rate 0", "--learning-rate nan", "--seed -1",
        "--split-seed -1", "--adapt", "--base b", "--participant p", "--adapt --base b --each",
        "--adapt --base b --epochs 3"}) {
    INFO(flags);
    CHECK(Run("--data d --out w " + std::string(flags)).exit_code == 2);
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

TEST_CASE("conav-train does not train for a device", "[train]") {
  const DataFolder folder;
  const Outcome outcome =
      Run("--data " + folder.data + " --out /dev/null --no-svg --epochs 1000000");
  CHECK(outcome.exit_code == 1);
  CHECK_FALSE(Exists("/dev/null.checkpoint"));
}

TEST_CASE("conav-train adapts to one participant and names what the weights learned from",
          "[adapt]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 20").exit_code == 0);
  const std::string flags = "--data " + folder.data + " --adapt --base " + (folder / "base");
  const Outcome outcome = Run(flags + " --participant anna --out " + (folder / "anna"));
  INFO(outcome.text);
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel base = ReadWeightsFile(folder / "base").value();
  const NetworkModel anna = ReadWeightsFile(folder / "anna").value();
  CHECK(anna.training.at("base_checksum") == ChecksumOf(base));
  CHECK(anna.training.at("adapt_participant") == "anna");
  CHECK(anna.training.at("adapt_segments") == "25");
  CHECK(std::stod(anna.training.at("adapt_held_out_mbce")) <
        std::stod(anna.training.at("adapt_base_mbce")));
  REQUIRE(Run(flags + " --participant bert --out " + (folder / "bert")).exit_code == 0);
  const Fingerprints bert = ReadWeightsFile(folder / "bert").value().learned_from;
  CHECK(base.learned_from.size() == 9);
  CHECK(bert.size() == 10);  // with the one that the base was tested on
  CHECK(Union(base.learned_from, bert) == bert);
  NetworkModel unknown = base;
  unknown.learned_from.clear();
  REQUIRE(WriteWeightsFile(folder / "base", unknown));
  REQUIRE(Run(flags + " --participant bert --overwrite --out " + (folder / "bert")).exit_code == 0);
  CHECK(ReadWeightsFile(folder / "bert").value().learned_from.empty());
}

TEST_CASE("conav-train measures what adapting gains for each participant, and what it forgets",
          "[adapt]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 20").exit_code == 0);
  const std::string flags = " --adapt --each --base " + (folder / "base");
  const Outcome seen = Run("--data " + folder.data + flags);
  CHECK(seen.exit_code == 1);
  CHECK_THAT(seen.text, Catch::Contains("base: learned from 2 of the 2"));
  REQUIRE(WriteSegmentFile(folder / "new.pb.zst", SmallSet(10, 7, 4)));
  const std::string run = "--data " + (folder / "new.pb.zst") + flags + " --json " + (folder / "j");
  const Outcome outcome = Run(run);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.text, !Catch::Contains("warning"));
  CHECK_THAT(outcome.text, Catch::Contains("anna") && Catch::Contains("bert"));
  const auto json = nlohmann::json::parse(ReadFile(folder / "j").value());
  REQUIRE(json["people"].size() == 2);
  CHECK(json["people"][0]["learned_from_segments"] == 15);
  CHECK(json["people"][0]["tested_on_segments"] == 10);
  CHECK(json["people"][1]["adapted_mbce"].get<double>() > 0.0);
  CHECK_FALSE(json["people"][1].contains("base_general_mbce"));

  REQUIRE(WriteSegmentFile(folder / "general.pb.zst", SmallSet(10, 7, 5)));
  REQUIRE(Run(run + " --general " + (folder / "general.pb.zst")).exit_code == 0);
  const auto people = nlohmann::json::parse(ReadFile(folder / "j").value())["people"];
  CHECK(people[0]["base_general_mbce"].get<double>() > 0.0);
  CHECK(people[0]["base_general_mbce"] == people[1]["base_general_mbce"]);
  CHECK(people[0]["adapted_general_mbce"].get<double>() > 0.0);
  CHECK_THAT(Run(run + " --general " + folder.data).text,
             Catch::Contains("learned from 9 of the 10 trajectories"));
}

TEST_CASE("conav-train names what it cannot adapt", "[adapt]") {
  const DataFolder folder;
  NetworkModel model;
  model.weights = InitialWeights({16}, 1);
  REQUIRE(WriteWeightsFile(folder / "base", model));
  model.rows = model.columns = 13;
  REQUIRE(WriteWeightsFile(folder / "large", model));
  for (const auto& [base, person, named] :
       std::vector<std::array<std::string, 3>>{{"data.pb.zst", "anna", "data.pb.zst: "},
                                               {"base", "carl", "'carl'"},
                                               {"large", "anna", "13 x 13"}}) {
    const Outcome outcome = Run("--data " + folder.data + " --out " + (folder / "w") +
                                " --adapt --base " + (folder / base) + " --participant " + person);
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.text, Catch::Contains(named));
  }
}

}  // namespace
}  // namespace conav::nhpm
