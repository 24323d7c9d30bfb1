#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/runtime/threads.h"

namespace conav::nhpm {

/// What `conav train --adapt` was told.
struct AdaptArguments {
  std::filesystem::path base;  // weights file
  std::filesystem::path data;
  std::filesystem::path out;      // not with `each`
  std::filesystem::path json;     // "-" = standard output; empty = not wanted
  bool overwrite = false;         // `out` may hold weights of another training
  std::string participant;        // may be empty where the data has only one
  bool each = false;              // measure for every participant of the data, write no weights
  std::filesystem::path general;  // segments of everybody, for `each`: what adapting forgets
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Adapts the base to one participant and writes the weights. With `each`: adapts to half of the
/// trajectories of each participant and prints the losses of base and adapted network on the other
/// half, and on all of `general`. Exit code: 0 done, 1 failed or stopped.
int RunAdapt(const AdaptArguments& arguments, const StopToken& stop);

}  // namespace conav::nhpm
