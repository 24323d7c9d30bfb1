#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "nhpm/dataset/annotators.h"
#include "operator/simulated/synthetic_operator.h"
#include "study/design.h"

namespace conav::study {

/// The population without a file: the careful people of annotators.yaml, the paper's population
/// after its filter (Appendix A), which drops those whose map stays wrong.
nhpm::AnnotatorPopulation DefaultPopulation();

/// A SYNTHETIC person, the same for equal seeds. How they read pictures is drawn from the
/// population; on top of that, bell-shaped (mean -+ SD, within limits):
///
///   planner.wall_crossing_cost      10 -+ 2, in 4 to 16 steps: how much they mind drawing a path
///                                   through a wall of their map
///   glance_rate                     0.03 -+ 0.005, in 0.01 to 0.05: share of streamed pictures that
///                                   they look at
///   steering.slip_probability       0.02 -+ 0.008, in 0 to 0.05: a wrong key instead of the right one
///   steering.overshoot_probability  0.05 -+ 0.02, in 0 to 0.12: a key held one step too long
///
/// steering.reaction_steps is 2 low-level steps for one person of four, else 1. All else is that of a
/// "careful" simulated operator. Nobody fitted these numbers to data.
operators::SyntheticOperatorParameters DrawPerson(const nhpm::AnnotatorPopulation& population,
                                                  std::uint64_t seed);

/// A file for `conav demo --operator` and `conav up simulated-operator`.
std::string PersonYaml(const operators::SyntheticOperatorParameters& person);

/// What `conav study` was asked for.
struct StudyOptions {
  DesignOptions design;
  int robots = 1;  // in the world, one operator for all
  int jobs = 1;    // episodes at a time
  std::string camera = "none";
  std::string dds;                   // as `conav demo --dds`
  std::filesystem::path weights;     // as `conav demo --weights`
  std::filesystem::path population;  // file like annotators.yaml; empty = DefaultPopulation()
  bool recording = false;            // each episode, as `conav demo` does
  double time_limit_s = 300.0;       // wall time of an episode
  std::filesystem::path out;         // empty = DefaultOut()
  std::filesystem::path json;
  bool check = false;  // a missed bar is a failure
};

/// "runs/study-14x3-seed1-0a1b2c3d": another one for each design, by its fingerprint's begin.
std::filesystem::path DefaultOut(const StudyOptions& options, const std::string& fingerprint);

/// What all episodes have in common.
launcher::DemoOptions BaseDemo(const StudyOptions& options);

/// Refuses what cannot be: the option by name, its value, what would do.
[[nodiscard]] Result<void> Validate(const StudyOptions& options);

}  // namespace conav::study
