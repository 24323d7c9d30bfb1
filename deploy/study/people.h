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
/// population; on top of that, bell-shaped, how much they mind drawing a path through a wall of
/// their map (extra cost 10 -+ 2 steps, within 4 to 16) and which share of streamed pictures they
/// look at (0.30 -+ 0.05, within 0.1 to 0.5). All else is that of a "careful" simulated operator.
/// Nobody fitted these numbers to data.
operators::SyntheticOperatorParameters DrawPerson(const nhpm::AnnotatorPopulation& population,
                                                  std::uint64_t seed);

/// A file for `conav demo --operator` and `conav up simulated-operator`.
std::string PersonYaml(const operators::SyntheticOperatorParameters& person);

}  // namespace conav::study
