#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "common/runtime/result.h"
#include "planner/record/decision_record.h"

namespace conav::planner {

/// Reads what DecisionLog wrote and calls `take` with each decision, in the order of the file, also
/// while it grows. True when it ends inside of a decision, as it does when the planner was killed:
/// all before that are taken.
/// Errors, with path and the decision's place: kNotFound; kIo; kMalformed (empty, no zstd, damaged,
/// something else, another schema version).
[[nodiscard]] Result<bool> ReadDecisions(const std::filesystem::path& path,
                                         const std::function<void(DecisionRecord&&)>& take);

/// Whether complete `frames` of the file `path` begin as a file of decisions does.
[[nodiscard]] Result<void> CheckHeader(const std::filesystem::path& path, std::string_view frames);

}  // namespace conav::planner
