#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/msg/search_report.h"
#include "common/runtime/result.h"
#include "planner/explain/decision_file.h"
#include "planner/explain/decision_text.h"

namespace conav::planner {

/// "east", "north-east"; "30 degrees" where it is none of eight. 0 is east, counter-clockwise.
std::string HeadingName(double heading_rad);

/// "move east to (7,8)" from `robot`, "picture to the north-east", "low-level action".
std::string ActionName(const SearchAction& action, Cell robot);

/// Whether both command the same.
bool IsSameCommand(const SearchAction& a, const SearchAction& b);

/// Numbers of decisions, both ends included.
struct DecisionRange {
  std::uint64_t first = 1;
  std::uint64_t last = UINT64_MAX;
  bool Contains(std::uint64_t number) const { return first <= number && number <= last; }
  bool is_one() const { return first == last; }
};

/// "12" or "12..20". Errors: kInvalidArgument.
[[nodiscard]] Result<DecisionRange> ParseDecisionRange(std::string_view text);

/// The terms of a value with their names, in the order in which they are shown.
using NamedTerms = std::array<std::pair<const char*, double>, 7>;
NamedTerms Named(const RewardTerms& terms);

/// The root's actions by visits, then value, then their order; those that were never tried last.
std::vector<SearchAction> RankedActions(const SearchReport& report);

/// What `decision` commanded as the search saw it; null when no search offered it.
const SearchAction* TakenAction(const DecisionRecord& decision);

/// The most visited other action; null when no other was tried.
const SearchAction* RunnerUp(const DecisionRecord& decision);

/// Value of the action taken less that of the runner-up; 0 without one.
double Margin(const DecisionRecord& decision);

/// Why the robot did what it did, in sentences made from the figures of the decision.
std::vector<std::string> Why(const DecisionRecord& decision);

struct DecisionQuery {
  std::string robot;  // empty = any
  DecisionRange range;
  bool snapshots_only = false;
};

/// The requested part of a run's records.
struct RunDecisions {
  std::vector<DecisionSummary> list;  // file by file, in their order
  std::optional<DecisionRecord> one;  // the last that the query met; only when it names one number
  int found = 0;                      // so many it met
  std::vector<std::string> notes;     // for standard error: files that end inside of a decision
};

/// Reads `run`: a run folder with its files decisions*.pb.zst, or such a file.
/// Errors, for people: kNotFound: no such folder; it has no decisions (it was made before they were
/// recorded, or by a planner that does not record); no such robot; no such decision, with those
/// that there are. kMalformed, kIo: a file cannot be read.
[[nodiscard]] Result<RunDecisions> ReadRun(const std::filesystem::path& run,
                                           const DecisionQuery& query);

}  // namespace conav::planner
