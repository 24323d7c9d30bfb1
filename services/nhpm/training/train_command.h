#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

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

/// The arguments of `conav train --adapt`.
struct AdaptArguments {
  std::filesystem::path base;  // weights file
  std::filesystem::path data;
  std::filesystem::path out;      // not with `each`
  std::filesystem::path json;     // "-" = standard output; empty = off
  bool overwrite = false;         // `out` may hold weights of another training
  std::string participant;        // may be empty if the data has only one
  bool each = false;              // measure for every participant of the data, write no weights
  std::filesystem::path general;  // with `each`: segments of everybody, to measure forgetting
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Adapts the base to one participant and writes the weights. With `each`: adapts to half of the
/// trajectories of each participant and prints the losses of base and adapted network on the other
/// half, and on all of `general`. Exit code: 0 done, 1 failed or stopped.
int RunAdapt(const AdaptArguments& arguments, const StopToken& stop);

}  // namespace conav::nhpm
