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

/// The stored result of a trial; seconds and minutes are simulation time.
struct SupervisionRecord {
  SupervisionTrial trial;
  std::string failure;  // empty = measured
  int attempts = 0;
  double minutes = 0.0;
  double goals = 0.0;  // of all robots
  OperatorWorkload workload;
  double wall_s = 0.0;  // from the simulators' start
  double pace = 0.0;    // simulated seconds per wall second, as a share of the requested ones

  bool is_complete() const { return failure.empty(); }
  bool has_failed() const { return !failure.empty(); }
  bool operator==(const SupervisionRecord&) const = default;
};

nlohmann::ordered_json ToJson(const SupervisionRecord& record);

/// Errors: kMalformed with the reason.
[[nodiscard]] Result<void> FromJson(const std::string& text, SupervisionRecord& record);

/// Runs one trial: all services as processes of their own over DDS, in a free domain; follows
/// robots and attention queue until every world's time is up.
/// Blocks. The record holds any error, including an interruption by `stop`. Its run folder stays
/// under `options.out`/runs/<trial>. Threads: one per call; several calls may run concurrently.
SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop);

}  // namespace conav::study
