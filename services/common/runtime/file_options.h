#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

/// A file and what names it in messages: {"--data", "my.pb.zst"}.
struct FileOption {
  std::string option;
  std::filesystem::path path;  // empty = not given
};

/// Refuses an output that is one of the inputs, which would be lost, or another output, however the
/// two paths are written. "-", devices and pipes may come twice.
/// Errors: kInvalidArgument, naming both options.
[[nodiscard]] Result<void> CheckDistinct(const std::vector<FileOption>& inputs,
                                         const std::vector<FileOption>& outputs);

}  // namespace conav
