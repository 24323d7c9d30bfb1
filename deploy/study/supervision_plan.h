#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "launcher/episode.h"
#include "launcher/run_folder.h"
#include "study/supervision_options.h"

namespace conav::study {

/// Everything that a trial's result depends on beside the trial itself and the program. What may
/// grow from one command to the next is not in it: numbers of robots, orders and seeds.
nlohmann::ordered_json DesignOf(const SupervisionOptions& options);

/// A process of a trial.
struct SupervisionProcess {
  std::string name;     // of its config and log file
  std::string program;  // "conav-sim"
  std::string config;   // YAML document
};

/// Robots of a trial in as many worlds as they need; the last world may hold fewer.
launcher::Episode EpisodeFor(const SupervisionTrial& trial, const SupervisionOptions& options);

/// Method of the world at `index`.
const std::string& MethodOf(std::size_t index, const SupervisionTrial& trial,
                            const SupervisionOptions& options);

/// Everything but the simulators, which start when the rest is ready: nhpm, the operator service,
/// a planner for each method, the simulated operator.
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

}  // namespace conav::study
