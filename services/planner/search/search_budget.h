#pragma once

#include <algorithm>
#include <optional>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "planner/search/search_options.h"

namespace conav::planner {

/// When to stop early, beyond the options' budget.
struct SearchLimits {
  const StopToken* stop = nullptr;
  /// Needed for the options' time budget and for `deadline`.
  const Clock* clock = nullptr;
  std::optional<Clock::TimePoint> deadline;
};

/// When a decision has to end: at the earliest of the caller's deadline and the options' time
/// budget, which begins to run at construction. Threads: const and safe to call concurrently, where
/// the clock is.
class SearchBudget {
 public:
  SearchBudget(const SearchOptions& options, const SearchLimits& limits)
      : limits_(limits), deadline_(limits.deadline) {
    if (limits.clock == nullptr || options.time_budget_ms <= 0.0) return;
    const auto end = limits.clock->Now() + Seconds(1e-3 * options.time_budget_ms);
    deadline_ = deadline_ ? std::min(end, *deadline_) : end;
  }

  /// One look at the clock, where there is a deadline.
  bool IsSpent() const {
    if (limits_.stop != nullptr && limits_.stop->stop_requested()) return true;
    return deadline_ && limits_.clock->Now() >= *deadline_;
  }

 private:
  SearchLimits limits_;
  std::optional<Clock::TimePoint> deadline_;
};

}  // namespace conav::planner
