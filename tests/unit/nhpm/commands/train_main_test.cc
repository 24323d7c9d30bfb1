#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "common/runtime/random.h"
#include "common/runtime/sha256.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "common/segments/trajectory_fingerprint.h"
#include "nhpm/model/weights_file.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

/// A folder of this test, its files as arguments of programs.
class Folder {
 public:
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  test::TemporaryFolder folder_;
};

/// conav-train as a process of its own, its standard output and error in one pipe.
class Program {
 public:
  explicit Program(const std::string& arguments) {
    const std::string command = "exec " CONAV_BIN_DIR "/conav-train " + arguments;
    std::array<int, 2> ends{};
    REQUIRE(pipe2(ends.data(), O_CLOEXEC) == 0);
    // A small pipe: the program cannot be far ahead of what was read of it.
    REQUIRE(fcntl(ends[1], F_SETPIPE_SZ, 4096) >= 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    std::string shell = "/bin/sh";
    std::string flag = "-c";
    std::string text = command;
    std::array<char*, 4> argv{shell.data(), flag.data(), text.data(), nullptr};
    REQUIRE(posix_spawn(&pid_, "/bin/sh", &actions, nullptr, argv.data(), environ) == 0);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ~Program() {
    if (!reaped_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::fclose(output_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Reads on until `part` was printed; false when the program ends first.
  bool ReadUntil(const std::string& part) {
    for (int c = std::fgetc(output_); c != EOF; c = std::fgetc(output_)) {
      text_ += static_cast<char>(c);
      if (text_.ends_with(part)) return true;
    }
    return false;
  }
  void Signal(int signal) { kill(pid_, signal); }

  /// Exit code, or 128 + the signal that ended it.
  int Wait() {
    ReadUntil("nothing of the kind\n");
    int status = 0;
    waitpid(pid_, &status, 0);
    reaped_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  const std::string& text() const { return text_; }

 private:
  pid_t pid_ = -1;
  std::FILE* output_ = nullptr;
  std::string text_;
  bool reaped_ = false;
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

std::string DataIn(const Folder& folder) {
  REQUIRE(WriteSegmentFile(folder / "data.pb.zst", SmallSet(10)));
  return folder / "data.pb.zst";
}

std::string Flags(const Folder& folder, const std::string& out) {
  return "--data " + (folder / "data.pb.zst") + " --out " + (folder / out) +
         " --width 16 --batch 16 --patience 0 ";
}

bool Exists(const std::string& path) { return std::filesystem::exists(path); }

TEST_CASE("conav-train writes weights, a curve and figures", "[nhpm][train]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  const Outcome outcome =
      Run(Flags(folder, "w.nhpm") + "--epochs 3 --seed 5 --json " + (folder / "w.json"));
  INFO(outcome.text);
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel model = ReadWeightsFile(folder / "w.nhpm").value();
  CHECK(model.weights.shape.width == 16);
  CHECK(model.rows == 7);
  CHECK(model.data_origin == "synthetic");
  CHECK(model.training.at("seed") == "5");
  CHECK(model.training.at("epochs_done") == "3");
  CHECK(model.training.at("data_sha256") == Sha256Hex(ReadFile(data).value()));
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

TEST_CASE("conav-train writes the same bytes on any number of threads", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  REQUIRE(Run(Flags(folder, "1") + "--epochs 4 --threads 1").exit_code == 0);
  REQUIRE(Run(Flags(folder, "3") + "--epochs 4 --threads 3").exit_code == 0);
  CHECK((ReadFile(folder / "1").value() == ReadFile(folder / "3").value()));
}

TEST_CASE("conav-train that was killed goes on and ends with the same bytes", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  REQUIRE(Run(Flags(folder, "whole") + "--epochs 300").exit_code == 0);
  const std::string flags = Flags(folder, "killed") + "--epochs 300";
  for (const char* line : {"epoch   2/300", "epoch  40/300"}) {
    Program program(flags);
    REQUIRE(program.ReadUntil(line));
    program.Signal(SIGKILL);
    REQUIRE(program.Wait() == 128 + SIGKILL);
    REQUIRE_FALSE(Exists(folder / "killed"));
  }
  const Outcome outcome = Run(flags);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.text, Catch::Contains("going on from " + (folder / "killed.checkpoint")));
  CHECK((ReadFile(folder / "killed").value() == ReadFile(folder / "whole").value()));
}

TEST_CASE("conav-train stops on SIGINT, says so and keeps its checkpoint", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  Program program(Flags(folder, "w") + "--epochs 1000000");
  REQUIRE(program.ReadUntil("epoch   2/1000000"));
  program.Signal(SIGINT);
  CHECK(program.Wait() == 1);
  CHECK_THAT(program.text(), Catch::Contains("stopped after epoch") &&
                                 Catch::Contains("the same command goes on from"));
  CHECK(Exists(folder / "w.checkpoint"));
  CHECK_FALSE(Exists(folder / "w"));
}

TEST_CASE("conav-train refuses a checkpoint of another training, unless told to start anew",
          "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  {
    Program program(Flags(folder, "w") + "--epochs 1000000");
    REQUIRE(program.ReadUntil("epoch   2/"));
    program.Signal(SIGKILL);
    program.Wait();
  }
  const Outcome refused = Run(Flags(folder, "w") + "--epochs 2 --seed 2 --without tau");
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.text, Catch::Contains("is of another training: epochs 1000000 there, 2 now; "
                                           "inputs x,tau,o there, x,o now; seed 1 there, 2 now; "
                                           "--fresh starts anew"));
  CHECK(Run(Flags(folder, "w") + "--epochs 2 --seed 2 --fresh").exit_code == 0);
}

TEST_CASE("conav-train refuses a damaged checkpoint", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  REQUIRE(WriteFile(folder / "w.checkpoint", "CNVC and then something else"));
  const Outcome outcome = Run(Flags(folder, "w") + "--epochs 1");
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.text,
             Catch::Contains(folder / "w.checkpoint: ") && Catch::Contains("--fresh starts anew"));
}

TEST_CASE("conav-train leaves inputs out and says so in the weights", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  REQUIRE(Run(Flags(folder, "w") + "--epochs 1 --without tau,o --any-size").exit_code == 0);
  const NetworkModel model = ReadWeightsFile(folder / "w").value();
  CHECK(model.inputs == InputSelection{.belief = true, .path = false, .view = false});
  CHECK(model.rows == 0);
}

TEST_CASE("conav-train names in the weights the trajectories that they learned from",
          "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  REQUIRE(Run(Flags(folder, "w") + "--epochs 1 --split-seed 4").exit_code == 0);
  const SegmentSplit split = SplitSegments(SmallSet(10), 4);
  const Fingerprints learned_from = ReadWeightsFile(folder / "w").value().learned_from;
  CHECK(learned_from.size() == 9);
  CHECK(CountKnown(split.train, learned_from) == 8);
  CHECK(CountKnown(split.validation, learned_from) == 1);
  CHECK(CountKnown(split.test, learned_from) == 0);
}

TEST_CASE("conav-train says that standard output is full and exits with 1", "[nhpm][train]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  REQUIRE(Run(Flags(folder, "base") + "--epochs 1").exit_code == 0);
  REQUIRE(WriteSegmentFile(folder / "new.pb.zst", SmallSet(10, 7, 4)));
  const std::string adapt =
      "--data " + (folder / "new.pb.zst") + " --adapt --base " + (folder / "base");
  for (const std::string& flags :
       {Flags(folder, "w") + "--epochs 1", adapt + " --participant anna --out " + (folder / "p"),
        adapt + " --each"}) {
    for (const char* json : {"", " --json -"}) {
      const Outcome outcome = Run(flags + json + " >/dev/full");
      CHECK(outcome.exit_code == 1);
      CHECK_THAT(outcome.text, Catch::Contains("conav train: standard output: cannot write"));
    }
  }
}

TEST_CASE("conav-train names data that it cannot use", "[nhpm][train]") {
  const Folder folder;
  const auto text_of = [&](const SegmentSet& set) {
    REQUIRE(WriteSegmentFile(folder / "data.pb.zst", set));
    const Outcome outcome = Run(Flags(folder, "w") + "--epochs 1");
    CHECK(outcome.exit_code == 1);
    CHECK_FALSE(Exists(folder / "w"));
    return outcome.text;
  };
  CHECK_THAT(Run(Flags(folder, "w")).text, Catch::Contains(folder / "data.pb.zst: no such file"));
  REQUIRE(WriteFile(folder / "data.pb.zst", "no segments"));
  CHECK(Run(Flags(folder, "w")).exit_code == 1);
  CHECK_THAT(text_of({}), Catch::Contains("data.pb.zst: has no segments"));
  CHECK_THAT(text_of(SmallSet(2)), Catch::Contains("has 2 trajectories; training needs three"));
  SegmentSet two_sizes = SmallSet(4);
  two_sizes.trajectories.push_back(SmallSet(1, 9).trajectories[0]);
  CHECK_THAT(text_of(two_sizes), Catch::Contains("has maps of 7 x 7 and of 9 x 9 cells"));
}

TEST_CASE("conav-train knows before the first epoch that it cannot write", "[nhpm][train]") {
  const Folder folder;
  DataIn(folder);
  for (const std::string& flags :
       {std::string("--out /nonexistent/w"), "--out " + (folder / "w") + " --json /nonexistent/w",
        "--out " + (folder / "")}) {
    const Outcome outcome =
        Run("--data " + (folder / "data.pb.zst") + " --epochs 1000000 " + flags);
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.text, Catch::Contains("cannot write"));
  }
}

TEST_CASE("conav-train refuses wrong use with exit code 2", "[nhpm][train]") {
  for (const char* flags :
       {"", "--data d", "--out w", "--data d --out w --width 48", "--data d --out w --without z",
        "--data d --out w --epochs 0", "--data d --out w --learning-rate -1",
        "--data d --out w --adapt", "--data d --out w --base b", "--data d --out w --threads 0",
        "--data d --out w --adapt --base b --each", "--data d --out w --participant p",
        "--data d --out w --adapt --base b --epochs 3", "--data d --out w extra"}) {
    INFO(flags);
    CHECK(Run(flags).exit_code == 2);
  }
  CHECK(Run("--help").exit_code == 0);
}

TEST_CASE("conav-train adapts to one participant and keeps where the weights come from",
          "[nhpm][train][adapt]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  REQUIRE(Run(Flags(folder, "base") + "--epochs 20").exit_code == 0);
  const std::string flags = "--data " + data + " --adapt --base " + (folder / "base");
  const Outcome outcome = Run(flags + " --participant anna --out " + (folder / "anna"));
  INFO(outcome.text);
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel base = ReadWeightsFile(folder / "base").value();
  const NetworkModel anna = ReadWeightsFile(folder / "anna").value();
  CHECK(anna.training.at("base_checksum") == ChecksumOf(base));
  CHECK(anna.training.at("adapt_participant") == "anna");
  CHECK(anna.training.at("adapt_segments") == "25");
  CHECK((anna.weights.weights[1] == base.weights.weights[1]));
  CHECK_FALSE((anna.weights.weights[3] == base.weights.weights[3]));
  CHECK(std::stod(anna.training.at("adapt_held_out_mbce")) <
        std::stod(anna.training.at("adapt_base_mbce")));
}

TEST_CASE("adapted weights name what their base learned from, and the person's trajectories",
          "[nhpm][train][adapt]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  REQUIRE(Run(Flags(folder, "base") + "--epochs 1").exit_code == 0);
  const std::string flags = "--data " + data + " --adapt --participant bert --out ";
  REQUIRE(Run(flags + (folder / "bert") + " --base " + (folder / "base")).exit_code == 0);
  const Fingerprints base = ReadWeightsFile(folder / "base").value().learned_from;
  const Fingerprints bert = ReadWeightsFile(folder / "bert").value().learned_from;
  CHECK(base.size() == 9);
  CHECK(bert.size() == 10);  // with the one that the base was tested on
  CHECK(Union(base, bert) == bert);
  NetworkModel unknown = ReadWeightsFile(folder / "base").value();
  unknown.learned_from.clear();
  REQUIRE(WriteWeightsFile(folder / "unknown", unknown));
  REQUIRE(Run(flags + (folder / "bert") + " --base " + (folder / "unknown")).exit_code == 0);
  CHECK(ReadWeightsFile(folder / "bert").value().learned_from.empty());
}

TEST_CASE("conav-train measures what adapting gains for each participant", "[nhpm][train][adapt]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  REQUIRE(Run(Flags(folder, "base") + "--epochs 20").exit_code == 0);
  const std::string flags = " --adapt --each --base " + (folder / "base");
  const Outcome seen = Run("--data " + data + flags);
  CHECK(seen.exit_code == 1);
  CHECK_THAT(seen.text, Catch::Contains("base: learned from 2 of the 2 trajectories of anna that "
                                        "it would be tested on"));
  REQUIRE(WriteSegmentFile(folder / "new.pb.zst", SmallSet(10, 7, 4)));
  const Outcome outcome =
      Run("--data " + (folder / "new.pb.zst") + flags + " --json " + (folder / "j"));
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.text, !Catch::Contains("warning"));
  CHECK_THAT(outcome.text, Catch::Contains("anna") && Catch::Contains("bert"));
  const auto json = nlohmann::json::parse(ReadFile(folder / "j").value());
  REQUIRE(json["people"].size() == 2);
  CHECK(json["people"][0]["learned_from_segments"] == 15);
  CHECK(json["people"][0]["tested_on_segments"] == 10);
  CHECK(json["people"][1]["adapted_mbce"].get<double>() > 0.0);
}

TEST_CASE("conav-train names what it cannot adapt", "[nhpm][train][adapt]") {
  const Folder folder;
  const std::string data = DataIn(folder);
  const auto text_of = [&](const std::string& flags) {
    const Outcome outcome =
        Run("--data " + data + " --out " + (folder / "w") + " --adapt " + flags);
    CHECK(outcome.exit_code == 1);
    return outcome.text;
  };
  CHECK_THAT(text_of("--base /nonexistent/b"), Catch::Contains("/nonexistent/b: no such file"));
  CHECK_THAT(text_of("--base " + data), Catch::Contains("data.pb.zst: no weights file"));
  NetworkModel model;
  model.weights = InitialWeights({16}, 1);
  REQUIRE(WriteWeightsFile(folder / "base", model));
  const std::string base = "--base " + (folder / "base");
  CHECK_THAT(text_of(base), Catch::Contains("--participant must say to whom to adapt"));
  CHECK_THAT(text_of(base + " --participant carl"), Catch::Contains("no participant 'carl'"));
  model.rows = 13;
  model.columns = 13;
  REQUIRE(WriteWeightsFile(folder / "base", model));
  CHECK_THAT(text_of(base + " --participant anna"),
             Catch::Contains("has maps of 7 x 7 cells; the base is for 13 x 13"));
}

}  // namespace
}  // namespace conav::nhpm
