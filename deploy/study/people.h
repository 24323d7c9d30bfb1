#pragma once

#include <cstdint>
#include <string>

#include "nhpm/synthesis/annotator_population.h"
#include "operator/simulated/synthetic_operator.h"

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

}  // namespace conav::study
