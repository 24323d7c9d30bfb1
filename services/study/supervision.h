#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/msg/method.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "launcher/run_folder.h"
#include "launcher/run_log.h"
#include "operator/simulated/config.h"

namespace conav::study {

/// The methods whose robots ask for help and continue without it.
inline constexpr std::array kSupervisedMethods{MethodKind::kIgMcts, MethodKind::kInstruction};

/// The options of `conav study --supervision`. All seconds and minutes are simulation time.
struct SupervisionOptions {
  std::vector<int> robots{1, 2, 4, 8, 16};
  std::vector<std::string> orders{"priority", "fifo", "nearest_deadline"};
  /// Assigned to the worlds in turn; each seed starts with another one.
  std::vector<MethodKind> methods{kSupervisedMethods.begin(), kSupervisedMethods.end()};
  /// Of the simulated operator.
  operators::InteractionTimeParameters interaction{4.0, 6.0, 6.0, 0.5};
  int seeds = 10;
  std::uint64_t seed = 1;  // the first
  double minutes = 4.0;    // of a trial
  int goals = 30;          // of each robot: more than it can reach in that time
  int robots_per_world = 1;
  // a robot continues without an answer to its picture after this time
  double answer_timeout_s = 60.0;
  double speed = 20.0;  // simulated seconds per wall second
  int jobs = 1;
  std::string dds;
  std::filesystem::path out;  // empty = runs/supervision-<fingerprint of the design>
  std::filesystem::path json;
};

/// Robots of one operator, at most.
inline constexpr int kMostSupervised = 16;

/// Parses "picture=6,blocked=10,path=12,log_sd=0.5"; unnamed values stay. Errors: kInvalidArgument.
[[nodiscard]] Result<void> ParseInteractionTimes(const std::string& text,
                                                 operators::InteractionTimeParameters& times);

/// Rejects impossible options: names the option, its value and what is allowed.
[[nodiscard]] Result<void> Validate(const SupervisionOptions& options);

/// One run of all services.
struct SupervisionTrial {
  int robots = 1;
  std::string order;
  std::uint64_t seed = 1;
  std::string name() const;  // "n04-fifo-seed3"
  bool operator==(const SupervisionTrial&) const = default;
};

/// Orders innermost, so that comparable trials run close together.
std::vector<SupervisionTrial> TrialsOf(const SupervisionOptions& options);

/// Everything that a trial's result depends on besides the trial itself and the program. Excludes
/// what may grow from one command to the next: numbers of robots, orders and seeds.
nlohmann::ordered_json DesignOf(const SupervisionOptions& options);

/// A process of a trial.
struct SupervisionProcess {
  std::string name;     // of its config and log file
  std::string program;  // "conav-sim"
  std::string config;   // YAML document
};

/// The robots of a trial in as many worlds as they need; the last world may hold fewer.
launcher::Episode EpisodeFor(const SupervisionTrial& trial, const SupervisionOptions& options);

/// Method of the world at `index`.
MethodKind MethodOf(std::size_t index, const SupervisionTrial& trial,
                    const SupervisionOptions& options);

/// Everything except the simulators, which start when the rest is ready: nhpm, the operator
/// service, a planner for each method, the simulated operator.
std::vector<SupervisionProcess> PlanServices(const SupervisionTrial& trial,
                                             const SupervisionOptions& options,
                                             const bus::ParticipantOptions& bus,
                                             const launcher::Episode& episode,
                                             const launcher::RunFolder& run);

/// A simulator for each world, at the study's speed, without a camera.
std::vector<SupervisionProcess> PlanSimulators(const SupervisionTrial& trial,
                                               const SupervisionOptions& options,
                                               const bus::ParticipantOptions& bus,
                                               const launcher::Episode& episode);

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

/// Throws nlohmann::json::exception.
[[nodiscard]] Result<void> FromJson(const nlohmann::json& json, SupervisionRecord& record);

/// Runs one trial: all services as processes of their own over DDS, in a free domain; follows
/// robots and attention queue until every world's time is up.
/// Blocks. The record holds any error, including an interruption by `stop`. Its run folder stays
/// under `options.out`/runs/<trial>. Threads: one per call; several calls may run concurrently.
SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop);

}  // namespace conav::study
