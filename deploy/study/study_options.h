#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "study/design.h"

namespace conav::study {

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
