#pragma once

#include <filesystem>

namespace conav::operators {

/// What `conav replay` was told.
struct ReplayArguments {
  std::filesystem::path run;       // run folder or MCAP file
  int port = 8080;                 // 0 = any that is free
  std::filesystem::path url_file;  // empty = none
  std::filesystem::path web;       // folder of the page; empty = the one beside the program
};

/// Serves the console on the recording until SIGINT or SIGTERM; prints its address on standard
/// output. Exit code: 0 ended so, 1 failed, 2 wrong use.
int RunReplay(const ReplayArguments& arguments);

}  // namespace conav::operators
