#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "common/runtime/config.h"
#include "common/runtime/random.h"
#include "launcher/demo_plan.h"
#include "study/design.h"
#include "study/study_run.h"

namespace conav::study {
namespace {

/// A config file with section `simulated_operator:`, holding only the person.
struct PersonFile {
  operators::SyntheticOperatorParameters person;
  void Visit(ConfigReader& reader) { reader.Section("person", person); }
};

/// The sum of twelve uniform numbers: bell-shaped, the same on every machine.
double Bell(double mean, double deviation, double low, double high, Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.Unit();
  return std::clamp(mean + deviation * sum, low, high);
}

constexpr int kMostOperators = 10000;
constexpr int kMostLayouts = 1000;
constexpr int kMostJobs = 64;

Result<void> RequireCount(const char* option, int value, int most) {
  if (value >= 1 && value <= most) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("{} {}: not between 1 and {}", option, value, most));
}

Result<void> ValidatePopulation(const std::filesystem::path& file) {
  if (file.empty()) return {};
  try {
    nhpm::ReadPopulation(file);
    return {};
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--population: {}", error.what()));
  }
}

Result<void> ValidateMethods(const std::vector<std::string>& methods) {
  const auto count = static_cast<int>(methods.size());
  if (count < 1 || count > kOrientations) {
    return Fail(ErrorCode::kOutOfRange, fmt::format("--methods: {} methods; 1 to {} are possible, "
                                                    "since a layout has that many orientations",
                                                    count, kOrientations));
  }
  for (const std::string& method : methods) {
    if (std::ranges::find(kDemoMethods, method) != kDemoMethods.end()) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--methods: {} is not one of {}", method,
                                                         fmt::join(kDemoMethods, ", ")));
  }
  const std::set<std::string> distinct(methods.begin(), methods.end());
  if (distinct.size() == methods.size()) return {};
  return Fail(ErrorCode::kInvalidArgument, "--methods: a method appears twice");
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

std::filesystem::path DefaultOut(const StudyOptions& options, const std::string& fingerprint) {
  const DesignOptions& design = options.design;
  return fmt::format("runs/study-{}x{}-seed{}-{:.8}", design.operators, design.layouts, design.seed,
                     fingerprint);
}

launcher::DemoOptions BaseDemo(const StudyOptions& options) {
  launcher::DemoOptions demo;
  demo.headless = true;
  demo.robots = options.robots;
  demo.camera = options.camera;
  demo.dds = options.dds;
  demo.weights = options.weights;
  demo.recording = options.recording;
  demo.time_limit_s = options.time_limit_s;
  demo.out = options.out.empty() ? "runs" : options.out;
  return demo;
}

Result<void> Validate(const StudyOptions& options) {
  const DesignOptions& design = options.design;
  if (auto ok = RequireCount("--operators", design.operators, kMostOperators); !ok) return ok;
  if (auto ok = RequireCount("--layouts", design.layouts, kMostLayouts); !ok) return ok;
  if (auto ok = RequireCount("--jobs", options.jobs, kMostJobs); !ok) return ok;
  if (auto ok = ValidateMethods(design.methods); !ok) return ok;
  if (auto ok = CheckDomains(options.jobs); !ok) return ok;
  if (auto ok = ValidatePopulation(options.population); !ok) return ok;
  launcher::DemoOptions demo = BaseDemo(options);
  for (const std::string& method : design.methods) {
    demo.method = method;
    if (auto ok = launcher::Validate(demo); !ok) return ok;
  }
  for (const std::uint64_t layout : MakeDesign(design).layouts) {
    demo.maze_seed = layout;
    if (auto ok = launcher::CheckWorlds(demo); !ok) return ok;
  }
  return launcher::CheckWeights(demo);
}

}  // namespace conav::study
