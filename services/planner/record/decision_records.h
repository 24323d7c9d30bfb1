#pragma once

#include <decisions.pb.h>

#include "common/runtime/result.h"
#include "planner/record/decision_record.h"

/// Between decisions and the records of idl/decisions.proto, which go no further.
namespace conav::planner {

inline constexpr std::uint32_t kDecisionSchemaVersion = 1;

decisions::Record HeaderRecord();
/// Cells outside of the map are left out of goals, path, guidance and plan.
decisions::Record ToRecord(const DecisionRecord& decision);

/// Errors: kMalformed names what no decision can have: a map's size or value, a cell, a parent in
/// the tree, a probability, columns of different lengths.
[[nodiscard]] Result<DecisionRecord> ToDomain(const decisions::Decision& record);

}  // namespace conav::planner
