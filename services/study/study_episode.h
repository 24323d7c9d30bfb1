#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "launcher/domain_lease.h"
#include "launcher/run_log.h"
#include "study/design.h"

namespace conav::study {

/// The mean share of streamed pictures at which simulated people look (DrawPerson()).
inline constexpr double kGlances = 0.03;

/// The time of a person that an episode takes: counts x times per action, as simulated operators act
/// at once. Seconds.
struct HumanTime {
  double low = 0.0;  // 5th and
  double middle = 0.0;
  double high = 0.0;     // 95th percentile of the times
  double waiting = 0.0;  // of `middle`: robots stand meanwhile
  bool operator==(const HumanTime&) const = default;
};

/// The stored measures of an episode; sums over its robots.
struct EpisodeMeasures {
  double images = 0.0;  // including frames of a stream
  double image_bytes = 0.0;
  double h264_bytes = 0.0;       // the same with a stream as video; 0 = not encoded: H264Bytes()
  double low_level_steps = 0.0;  // of 0.25 s
  double cell_moves = 0.0;
  double distance_m = 0.0;          // driven
  double optimal_distance_m = 0.0;  // launcher::RobotMetrics; 0 = not known of one of them
  double guidance = 0.0;            // paths from the operator
  double mapping_accuracy_after = 0.0;
  double goals_reached = 0.0;
  double goals_total = 0.0;
  double time_s = 0.0;           // simulation time until the last robot was done
  double decision_ms_p95 = 0.0;  // wall time of a decision, of the robot with the largest
  HumanTime human;               // not stored: HumanTimeOf()
  bool all_goals_reached = false;
  bool operator==(const EpisodeMeasures&) const = default;
};

/// Per method (a picture or path takes a log-normal time, whose mean counts):
///   ig-mcts      each picture its time, each path its time; robots wait for both
///   instruction  each path its time, robots wait for it; of the streamed pictures the share kGlances
///                is looked at as long as a single one (low: none; high: the whole stream is watched)
///   teleop       each key its low-level step of 0.25 s
///   greedy       nothing: it ignores the operator
HumanTime HumanTimeOf(MethodKind method, const EpisodeMeasures& measures,
                      const operators::InteractionTimeParameters& times);

EpisodeMeasures MeasuresOf(const launcher::EpisodeMetrics& metrics);

/// One figure of table 3.
struct Measure {
  const char* key;     // in JSON, CSV and file names
  const char* header;  // of a column
  const char* title;
  double (*value)(const EpisodeMeasures&);
  bool is_share = false;  // in [0, 1]; all others are 0 or more
};

/// In the order of table 3: image_mib, sent_mib, h264_mib, low_level_steps, cell_moves, pictures, guidance,
/// mapping_accuracy_after, goals_reached_fraction, time_s, human_time_s.
std::span<const Measure> Measures();

/// The index of `key` in Measures(), which must contain it.
std::size_t MeasureIndex(const std::string& key);

enum class EpisodeStatus {
  kComplete,   // all goals reached
  kGoalsLeft,  // ended without all goals; measured up to its end
  kFailed,     // a process died or the run could not start: no measures
};

const char* NameOf(EpisodeStatus status);

/// The stored record of an episode.
struct EpisodeRecord {
  std::string name;  // PlannedEpisode::name
  EpisodeStatus status = EpisodeStatus::kFailed;
  std::string detail;  // why it is not complete
  int attempts = 0;
  double wall_s = 0.0;                      // of the last attempt
  std::string run;                          // run folder of the last attempt
  std::optional<EpisodeMeasures> measures;  // empty for a failed one

  bool is_complete() const { return status == EpisodeStatus::kComplete; }
  bool has_failed() const { return status == EpisodeStatus::kFailed; }
  bool operator==(const EpisodeRecord&) const = default;
};

nlohmann::ordered_json ToJson(const EpisodeRecord& record);

/// Errors: kMalformed with the reason. Throws nlohmann::json::exception.
[[nodiscard]] Result<void> FromJson(const nlohmann::json& json, EpisodeRecord& record);

/// The episode as a demo: all services as processes of their own. `base` has the options that all
/// episodes share: robots, camera, vendors, limits.
launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const std::filesystem::path& folder);

/// The bytes of a run's streamed pictures as H.264, a video per robot at the stream's 4 Hz, by ffmpeg
/// (libx264 with its default preset and quality). The run recorded its streams. Writes a temporary file
/// into its folder. Errors: kUnavailable when ffmpeg fails; those of the recording.
[[nodiscard]] Result<double> H264Bytes(const std::filesystem::path& run);

/// Runs episodes one after the other in a DDS domain that it keeps.
class DemoPlayer {
 public:
  /// `clock` and `stop` outlive it.
  DemoPlayer(std::filesystem::path program_folder, const Clock& clock, const StopToken& stop)
      : program_folder_(std::move(program_folder)), clock_(clock), stop_(stop) {}

  /// Blocks. The record, which is called `name`, holds any error.
  EpisodeRecord Play(const std::string& name, const launcher::DemoOptions& options);

 private:
  std::filesystem::path program_folder_;
  const Clock& clock_;
  const StopToken& stop_;
  std::optional<launcher::DomainLease> lease_;
};

}  // namespace conav::study
