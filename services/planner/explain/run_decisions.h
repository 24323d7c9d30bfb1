#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/explain/decision_range.h"
#include "planner/explain/decision_text.h"

namespace conav::planner {

struct DecisionQuery {
  std::string robot;  // empty = any
  DecisionRange range;
  bool pictures_only = false;
};

/// What a run recorded, as far as was asked for.
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
