#pragma once

#include <cstdint>
#include <filesystem>

#include "common/runtime/threads.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// What `conav train` was told; empty paths = not wanted.
struct TrainArguments {
  std::filesystem::path data;
  std::filesystem::path out;
  std::filesystem::path json;  // "-" = standard output
  std::filesystem::path svg;
  TrainingOptions options;
  InputSelection inputs;
  std::uint64_t split_seed = kDefaultSplitSeed;
  int threads = 1;
  bool any_size = false;   // the weights say that they fit maps of any size
  bool fresh = false;      // a checkpoint of `out` is not taken up
  bool overwrite = false;  // `out` may hold weights of another training
};

/// Where a training keeps its state until it is done.
std::filesystem::path CheckpointPath(const std::filesystem::path& out);

/// Trains, or goes on where a checkpoint of `out` ends; shows progress on standard error, the result
/// on standard output. Exit code: 0 done, 1 failed or stopped (the checkpoint is kept).
int RunTrain(const TrainArguments& arguments, const StopToken& stop);

}  // namespace conav::nhpm
