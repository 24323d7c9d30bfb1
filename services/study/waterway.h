#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "study/study_episode.h"

// One user: waterway_main; what is played and measured, without playing it, is tested alone.

/// The study behind figure 7 (paper, section 6.3): one robot crosses a waterway by a map of the
/// operator's that is outdated.
namespace conav::study {

/// What drives the robot.
enum class Crossing {
  kGreedy,  // greedy search, without an operator's path and without pictures
  kGuided,  // IG-MCTS with a simulated operator
  kAlone,   // IG-MCTS with an operator who never answers
};
inline constexpr std::array kCrossings{Crossing::kGreedy, Crossing::kGuided, Crossing::kAlone};

/// "greedy", "ig-mcts", "ig-mcts, no operator"
const char* TitleOf(Crossing crossing);

struct WaterwayOptions {
  int seeds = 30;
  std::uint64_t first_seed = 1;
  int jobs = 1;
  std::string camera = "egl";
  std::string dds;
  double time_limit_s = 600.0;  // wall time, of a crossing
  std::filesystem::path out;    // empty = in runs/, named by the design
  std::filesystem::path json;
  bool check = false;
};

/// Errors: the option, its value and what is allowed.
[[nodiscard]] Result<void> Validate(const WaterwayOptions& options);

struct WaterwayTrial {
  std::uint64_t seed = 1;
  Crossing crossing = Crossing::kGreedy;

  /// "seed007-greedy"
  std::string name() const;
};

std::vector<WaterwayTrial> TrialsOf(const WaterwayOptions& options);

/// Everything that the results depend on, except for the program itself.
nlohmann::ordered_json DesignOf(const WaterwayOptions& options);

/// The crossing as a demo, whose run folder lies in `folder`.
launcher::DemoOptions DemoOf(const WaterwayTrial& trial, const WaterwayOptions& options,
                             const std::filesystem::path& folder);

using WaterwayRecords = std::map<std::string, EpisodeRecord>;  // by WaterwayTrial::name()

struct CrossingSummary {
  Crossing crossing = Crossing::kGreedy;
  int trials = 0;
  int reached = 0;
  /// EpisodeMeasures::distance_m over its optimum; of all trials, infinite for those that did not reach
  /// the goal.
  double path_over_optimum_median = 0.0;
  double path_over_optimum_mean = 0.0;
  double path_over_optimum_worst = 0.0;
  /// Of the seeds: it drove less than greedy, or reached the goal and greedy did not.
  double shorter_than_greedy_fraction = 0.0;
  double pictures_mean = 0.0;
  double guidance_mean = 0.0;
  double mapping_accuracy_mean = 0.0;
  double decision_ms_p95 = 0.0;  // of the trial with the largest
};

struct WaterwaySummary {
  std::vector<CrossingSummary> crossings;
  std::vector<std::string> failed;  // names of trials that gave no measures
};

WaterwaySummary Summarise(const WaterwayOptions& options, const WaterwayRecords& records);

struct WaterwayBar {
  const char* title;
  double value = 0.0;
  double limit = 0.0;
  bool at_least = false;  // else at most
  bool met() const { return at_least ? value >= limit : value <= limit; }
};
std::vector<WaterwayBar> BarsOf(const WaterwaySummary& summary);

std::string WaterwayText(const WaterwaySummary& summary);
/// {"waterway": {"reached_fraction", "path_over_optimum_median", "shorter_than_greedy_fraction",
/// "decision_p95_ms"}, "crossings": [...], "bars": [...], "design"}; the first four are of IG-MCTS with an
/// operator.
nlohmann::ordered_json WaterwayJson(const WaterwaySummary& summary,
                                    const nlohmann::ordered_json& design);
/// A line per trial: seed, crossing, status, driven and shortest path in metres, pictures, paths given,
/// accuracy, seconds.
std::string WaterwayCsv(const WaterwayOptions& options, const WaterwayRecords& records);

}  // namespace conav::study
