#pragma once

#include <cstdint>
#include <filesystem>

#include "common/runtime/threads.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// The arguments of `conav train`; empty paths = off.
struct TrainArguments {
  std::filesystem::path data;
  std::filesystem::path out;
  std::filesystem::path json;  // "-" = standard output
  std::filesystem::path svg;
  TrainingOptions options;
  InputSelection inputs;
  std::uint64_t split_seed = kDefaultSplitSeed;
  int threads = 1;
  bool any_size = false;   // declare that the weights fit maps of any size
  bool fresh = false;      // ignore a checkpoint of `out`
  bool overwrite = false;  // `out` may hold weights of another training
};

/// The file that holds a training's state until it is done.
std::filesystem::path CheckpointPath(const std::filesystem::path& out);

/// Trains, or resumes from a checkpoint of `out`; shows progress on standard error, the result on
/// standard output. Exit code: 0 done, 1 failed or stopped (the checkpoint stays).
int RunTrain(const TrainArguments& arguments, const StopToken& stop);

}  // namespace conav::nhpm
