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

/// The default population: the careful people of annotators.yaml. It is the paper's population
/// after its filter (Appendix A), which drops those whose map stays wrong.
nhpm::AnnotatorPopulation DefaultPopulation();

/// A SYNTHETIC person, the same for equal seeds. The population gives how they read pictures; the
/// rest is bell-shaped (mean -+ SD, within limits):
///
///   planner.wall_crossing_cost      10 -+ 2, in 4 to 16 steps: the cost of drawing a path through
///   a
///                                   wall of their map
///   glance_rate                     0.03 -+ 0.005, in 0.01 to 0.05: share of streamed pictures
///   that
///                                   they look at
///   steering.slip_probability       0.02 -+ 0.008, in 0 to 0.05: a wrong key instead of the right
///   one
///   steering.overshoot_probability  0.05 -+ 0.02, in 0 to 0.12: a key held one step too long
///
/// steering.reaction_steps is 2 low-level steps for one person in four, else 1. Everything else is
/// that of a "careful" simulated operator. These numbers are not fitted to data.
operators::SyntheticOperatorParameters DrawPerson(const nhpm::AnnotatorPopulation& population,
                                                  std::uint64_t seed);

/// A file for `conav demo --operator` and `conav up simulated-operator`.
std::string PersonYaml(const operators::SyntheticOperatorParameters& person);

/// The options of `conav study`.
struct StudyOptions {
  DesignOptions design;
  int robots = 1;  // in the world, one operator for all
  int jobs = 1;    // episodes at a time
  std::string camera = "none";
  std::string dds;                   // as `conav demo --dds`
  std::filesystem::path weights;     // as `conav demo --weights`
  std::filesystem::path population;  // file like annotators.yaml; empty = DefaultPopulation()
  bool recording = false;            // of each episode, as in `conav demo`
  double time_limit_s = 300.0;       // wall time of an episode
  std::filesystem::path out;         // empty = DefaultOut()
  std::filesystem::path json;
  bool check = false;  // exit with an error when a bar is missed
};

/// "runs/study-14x3-seed1-0a1b2c3d": ends with the beginning of the design's fingerprint.
std::filesystem::path DefaultOut(const StudyOptions& options, const std::string& fingerprint);

/// The options that all episodes share.
launcher::DemoOptions BaseDemo(const StudyOptions& options);

/// Rejects impossible options: names the option, its value and what is allowed.
[[nodiscard]] Result<void> Validate(const StudyOptions& options);

}  // namespace conav::study
