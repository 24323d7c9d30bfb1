#include "study/people.h"

#include <algorithm>

#include "common/runtime/config.h"
#include "common/runtime/random.h"

namespace conav::study {
namespace {

/// Section `simulated_operator:` with nothing but the person.
struct PersonFile {
  operators::SyntheticOperatorParameters person;
  void Visit(ConfigReader& reader) { reader.Section("person", person); }
};

/// Twelve uniform numbers make a bell, the same on every machine.
double Bell(double mean, double deviation, double low, double high, Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.Unit();
  return std::clamp(mean + deviation * sum, low, high);
}

}  // namespace

nhpm::AnnotatorPopulation DefaultPopulation() {
  nhpm::AnnotatorPopulation population;
  population.careless_share = 0.0;
  return population;
}

operators::SyntheticOperatorParameters DrawPerson(const nhpm::AnnotatorPopulation& population,
                                                  std::uint64_t seed) {
  Random random(seed);
  operators::SyntheticOperatorParameters person = operators::ParametersOfKind("careful");
  person.reader = nhpm::DrawAnnotator(population, random).reader;
  person.planner.wall_crossing_cost = Bell(10.0, 2.0, 4.0, 16.0, random);
  person.glance_rate = Bell(0.03, 0.005, 0.01, 0.05, random);
  person.steering.slip_probability = Bell(0.02, 0.008, 0.0, 0.05, random);
  person.steering.overshoot_probability = Bell(0.05, 0.02, 0.0, 0.12, random);
  person.steering.reaction_steps = random.Chance(0.25) ? 2 : 1;
  return person;
}

std::string PersonYaml(const operators::SyntheticOperatorParameters& person) {
  return DumpConfig("simulated_operator", PersonFile{person});
}

}  // namespace conav::study
