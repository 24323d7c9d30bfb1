#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/segments/segment_split.h"

namespace conav::nhpm {

/// The arguments of `conav evaluate`; empty paths = off.
struct EvaluateArguments {
  std::filesystem::path data;
  std::vector<std::filesystem::path> weights;  // none = the shipped ones, if any
  std::vector<std::string> without;            // "tau", "o", "x": one more row for each
  std::uint64_t split_seed = kDefaultSplitSeed;
  bool all_test = false;  // no split: the weights never saw this file
  bool allow_seen = false;
  int oracle_draws = 20000;  // a segment; 0 = no oracle
  bool average_oracle = false;
  int threads = 1;
  std::vector<std::size_t> segments;  // for the page; none = chosen by content
  std::filesystem::path json;         // "-" = standard output, for the next two as well
  std::filesystem::path csv;
  std::filesystem::path html;
  bool check = false;  // a missed bar is a failure; no bar at all is wrong usage
};

/// Prints table 1 on standard output and writes the files; progress on standard error. Exit code: 0
/// done, 1 failed, 2 wrong usage.
int RunEvaluate(const EvaluateArguments& arguments);

}  // namespace conav::nhpm
