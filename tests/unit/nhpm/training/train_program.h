#pragma once

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

/// conav-train as its tests run it, and data for it.
namespace conav::nhpm {

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

inline Outcome Run(const std::string& arguments) {
  Program program(arguments);
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
