#pragma once

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
#include "common/runtime/text.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/weights_file.h"
#include "support/temporary_folder.h"

/// conav-train as its tests run it, and data for it.
namespace conav::nhpm {

using Folder = test::ArgumentFolder;

/// conav-train, or another, as a process of its own, its standard output and error in one pipe.
class Program {
 public:
  explicit Program(const std::string& arguments, const std::string& name = "conav-train") {
    const std::string command = "exec " CONAV_BIN_DIR "/" + name + " " + arguments;
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

inline Outcome Run(const std::string& arguments, const std::string& name = "conav-train") {
  Program program(arguments, name);
  const int code = program.Wait();
  return {code, program.text()};
}

/// A camera in the middle of the map that sees the cell to the east; the person copies what it shows.
inline Segment SmallSegment(int side, Random& random) {
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
inline SegmentSet SmallSet(int trajectories, int side = 7, std::uint64_t seed = 3) {
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

inline bool Exists(const std::string& path) { return std::filesystem::exists(path); }

}  // namespace conav::nhpm
