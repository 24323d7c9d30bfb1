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
  person.glance_rate = Bell(0.30, 0.05, 0.1, 0.5, random);
  return person;
}

std::string PersonYaml(const operators::SyntheticOperatorParameters& person) {
  return DumpConfig("simulated_operator", PersonFile{person});
}

}  // namespace conav::study
