#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "operator/replay/timeline.h"

namespace conav::operators {

struct RecordedRun {
  Timeline timeline;
  std::string name;
  /// What could not be read, in words: a file that was cut off, damaged chunks, messages that are
  /// not what their topic carries. The rest is in the timeline.
  std::vector<std::string> warnings;
};

/// Reads all that a console shows of the MCAP file `file`, which a conav recorder wrote. Pictures
/// and streams stay in memory. Errors: those of bag::McapReader::Open; kMalformed: not from a conav
/// recorder, or nothing in it.
[[nodiscard]] Result<RecordedRun> ReadRun(const std::filesystem::path& file);

}  // namespace conav::operators
