#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "operator/segments/segment_collector.h"

namespace conav::operators {

/// Entries "w1=conav13@7": world, preset or map file, seed ("@7" may be left out: 0).
/// Errors: kInvalidArgument names the entry.
[[nodiscard]] Result<std::map<std::string, MazeFacts>> ParseMazeFacts(
    const std::vector<std::string>& entries);

}  // namespace conav::operators
