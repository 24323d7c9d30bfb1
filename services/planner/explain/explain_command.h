#pragma once

#include <filesystem>
#include <string>

namespace conav::planner {

/// What `conav explain` was told; empty = not given.
struct ExplainArguments {
  std::filesystem::path run;
  std::string robot;
  std::string decision;  // "12" or "12..20"
  bool pictures = false;
  std::filesystem::path svg;  // "-" = standard output, as for the next
  std::filesystem::path json;
};

/// Prints one decision or a list on standard output, on standard error if that holds a document.
/// Exit code: 0 done, 1 failed, 2 wrong use.
int RunExplain(const ExplainArguments& arguments);

}  // namespace conav::planner
