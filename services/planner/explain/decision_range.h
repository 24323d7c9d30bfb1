#pragma once

#include <cstdint>
#include <string_view>

#include "common/runtime/result.h"

namespace conav::planner {

/// Numbers of decisions, both ends included.
struct DecisionRange {
  std::uint64_t first = 1;
  std::uint64_t last = UINT64_MAX;
  bool Contains(std::uint64_t number) const { return first <= number && number <= last; }
  bool is_one() const { return first == last; }
};

/// "12" or "12..20". Errors: kInvalidArgument.
[[nodiscard]] Result<DecisionRange> ParseDecisionRange(std::string_view text);

}  // namespace conav::planner
