#pragma once

#include <filesystem>

namespace conav::bag {

/// What `conav bag` was told; empty paths = not wanted.
struct BagArguments {
  std::filesystem::path run;  // run folder or MCAP file
  std::filesystem::path rosbag2;
  std::filesystem::path json;  // "-" = standard output
};

/// Prints what is in the recording on standard output, on standard error if that holds the JSON.
/// Exit code: 0 done, 1 failed, 2 wrong use.
int RunBag(const BagArguments& arguments);

}  // namespace conav::bag
