#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/runtime/result.h"
#include "study/measures.h"

namespace conav::study {

enum class EpisodeStatus {
  kComplete,   // all goals reached
  kGoalsLeft,  // ended without all goals; measured as far as it got
  kFailed,     // a process died or the run could not start: no measures
};

const char* NameOf(EpisodeStatus status);

/// What is kept on disk of an episode.
struct EpisodeRecord {
  std::string name;  // PlannedEpisode::name
  EpisodeStatus status = EpisodeStatus::kFailed;
  std::string detail;  // why it is not complete
  int attempts = 0;
  double wall_s = 0.0;                      // of the last attempt
  std::string run;                          // run folder of the last attempt
  std::optional<EpisodeMeasures> measures;  // none of a failed one

  bool is_complete() const { return status == EpisodeStatus::kComplete; }
  bool has_failed() const { return status == EpisodeStatus::kFailed; }
  bool operator==(const EpisodeRecord&) const = default;
};

nlohmann::ordered_json ToJson(const EpisodeRecord& record);

/// Errors: kMalformed with what is wrong.
[[nodiscard]] Result<void> FromJson(const std::string& text, EpisodeRecord& record);

}  // namespace conav::study
