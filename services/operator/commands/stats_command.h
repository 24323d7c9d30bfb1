#pragma once

#include <filesystem>

namespace conav::statistics {

/// What `conav stats` was told; empty paths = not wanted.
struct StatsArguments {
  std::filesystem::path data;
  std::filesystem::path json;  // "-" = standard output, as for the next
  std::filesystem::path html;
  double alpha = 0.05;  // in (0, 1)
};

/// Prints the tables on standard output, on standard error if that holds a document. Exit code: 0
/// done, 1 failed, 2 wrong use.
int RunStats(const StatsArguments& arguments);

}  // namespace conav::statistics
