#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "study/supervision_options.h"

namespace conav::study {

/// What came of a trial, and what is kept on disk of it; seconds and minutes are simulation time.
struct SupervisionRecord {
  SupervisionTrial trial;
  std::string failure;  // empty = measured
  int attempts = 0;
  double minutes = 0.0;
  double goals = 0.0;  // of all robots
  OperatorWorkload workload;
  double wall_s = 0.0;  // from the simulators' start
  double pace = 0.0;    // simulated seconds per wall second, as a share of what was asked for

  bool is_complete() const { return failure.empty(); }
  bool has_failed() const { return !failure.empty(); }
  bool operator==(const SupervisionRecord&) const = default;
};

nlohmann::ordered_json ToJson(const SupervisionRecord& record);

/// Errors: kMalformed with what is wrong.
[[nodiscard]] Result<void> FromJson(const std::string& text, SupervisionRecord& record);

/// Runs one trial: all services as processes of their own over DDS, in a domain where nobody else
/// is; listens to robots and attention queue until every world's time is up.
/// Blocks. Whatever goes wrong is in the record; a trial that `stop` ends says so, too. Its run
/// folder stays under `options.out`/runs/<trial>. Threads: one per call; several at a time are fine.
SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop);

}  // namespace conav::study
