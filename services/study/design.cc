#include "study/design.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "common/runtime/config.h"
#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "launcher/demo_plan.h"

namespace conav::study {
namespace {

/// Purposes for DeriveSeed.
constexpr std::uint64_t kOrderSeed = 1;
constexpr std::uint64_t kLayoutSeed = 2;
constexpr std::uint64_t kEpisodeSeed = 3;

std::uint64_t Below31Bits(std::uint64_t seed) { return seed >> 33; }

std::vector<std::uint64_t> ChooseLayouts(const DesignOptions& options) {
  std::vector<std::uint64_t> layouts(std::begin(kPaperLayouts), std::end(kPaperLayouts));
  Random random(DeriveSeed(options.seed, kLayoutSeed));
  const auto count = static_cast<std::size_t>(options.layouts);
  while (layouts.size() < count) {
    const std::uint64_t seed = Below31Bits(random.Next());
    if (std::find(layouts.begin(), layouts.end(), seed) == layouts.end()) layouts.push_back(seed);
  }
  layouts.resize(count);
  return layouts;
}

/// The row of the Williams design for each subject.
std::vector<std::size_t> ChooseRows(int operators, std::size_t rows, Random& random) {
  std::vector<std::size_t> chosen;
  while (chosen.size() < static_cast<std::size_t>(operators)) {
    std::vector<std::size_t> block(rows);
    for (std::size_t row = 0; row < rows; ++row) block[row] = row;
    random.Shuffle(block);
    chosen.insert(chosen.end(), block.begin(), block.end());
  }
  chosen.resize(static_cast<std::size_t>(operators));
  return chosen;
}

std::vector<int> Tasks(int layouts, Random& random) {
  std::vector<int> tasks;
  for (int layout = 0; layout < layouts; ++layout) tasks.push_back(layout);
  random.Shuffle(tasks);
  return tasks;
}

std::uint64_t EpisodeSeed(const DesignOptions& options, std::size_t number) {
  return Below31Bits(DeriveSeed(DeriveSeed(options.seed, kEpisodeSeed), number));
}

std::string NameOf(const PlannedEpisode& episode, const std::string& subject) {
  return fmt::format("{}-{}-{}-{}-{}r{}", subject, episode.session + 1, episode.task + 1,
                     episode.row.name, episode.maze_seed, episode.rotation_deg);
}

std::vector<StudyRow> RowsOf(const DesignOptions& options) {
  std::vector<StudyRow> rows;
  const double speed = options.teleop_speeds.front();
  for (const MethodKind method : options.methods) {
    rows.push_back({std::string(Name(method)), method, "search", speed});
  }
  const auto has = [&](MethodKind method) {
    return std::ranges::find(options.methods, method) != options.methods.end();
  };
  for (const std::string& name : options.references) {
    StudyRow row{name, MethodKind::kIgMcts, "search", speed};
    if (name == "greedy") {
      if (has(MethodKind::kGreedy)) continue;
      row.method = MethodKind::kGreedy;
    } else if (name == "never-send") {
      row.communication = "never";
    } else {
      row.search = name;
    }
    rows.push_back(std::move(row));
  }
  for (const double other : std::span(options.teleop_speeds).subspan(1)) {
    if (!has(MethodKind::kTeleop)) break;
    rows.push_back({fmt::format("teleop-{:g}", other), MethodKind::kTeleop, "search", other});
  }
  return rows;
}

/// The episodes of the rows that are no methods of the order.
void AddReferences(Design& design, const DesignOptions& options) {
  const std::vector<PlannedEpisode> ordered = design.episodes;
  for (std::size_t row = design.methods.size(); row < design.rows.size(); ++row) {
    for (const PlannedEpisode& first : ordered) {
      if (first.row != design.rows[0]) continue;
      PlannedEpisode episode = first;
      episode.session = static_cast<int>(row);
      episode.row = design.rows[row];
      episode.seed = EpisodeSeed(options, design.episodes.size());
      episode.name = NameOf(episode, design.subjects[static_cast<std::size_t>(first.subject)]);
      design.episodes.push_back(std::move(episode));
    }
  }
}

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

Result<void> ValidatePopulation(const std::filesystem::path& file) {
  if (file.empty()) return {};
  try {
    nhpm::ReadPopulation(file);
    return {};
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--population: {}", error.what()));
  }
}

Result<void> CheckRows(const DesignOptions& design) {
  if (static_cast<int>(design.methods.size()) > kOrientations) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--methods: {} of them; {} orientations allow as many methods",
                            design.methods.size(), kOrientations));
  }
  if (design.teleop_speeds.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--teleop-speed: is empty");
  }
  std::set<std::string> names;
  for (const StudyRow& row : RowsOf(design)) {
    if (names.insert(row.name).second) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: is named twice", row.name));
  }
  return {};
}

}  // namespace

Result<std::vector<MethodKind>> ParseMethods(const std::vector<std::string>& names,
                                             std::span<const MethodKind> allowed) {
  if (names.empty()) return Fail(ErrorCode::kInvalidArgument, "--methods: is empty");
  std::vector<MethodKind> methods;
  for (const std::string& name : names) {
    const auto method = ParseMethod(name);
    if (!method || std::ranges::find(allowed, *method) == allowed.end()) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--methods: {} is not one of {}", name, Join(Names(allowed), ", ")));
    }
    if (std::ranges::find(methods, *method) != methods.end()) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("--methods: {} is named twice", name));
    }
    methods.push_back(*method);
  }
  return methods;
}

std::string SearchOf(const StudyRow& row, const std::string& search_of_study) {
  if (row.method != MethodKind::kIgMcts) return "";
  return row.search.empty() ? search_of_study : row.search;
}

std::vector<std::vector<int>> WilliamsDesign(int conditions) {
  DEMAND(conditions >= 1, conditions);
  // First row 0, 1, k-1, 2, k-2, ...: all its steps from one condition to the next are different.
  std::vector<int> first;
  for (int place = 0; place < conditions; ++place) {
    first.push_back(place % 2 == 1 ? (place + 1) / 2 : (conditions - place / 2) % conditions);
  }
  std::vector<std::vector<int>> orders;
  for (int shift = 0; shift < conditions; ++shift) {
    std::vector<int> order;
    for (const int condition : first) order.push_back((condition + shift) % conditions);
    orders.push_back(std::move(order));
  }
  if (conditions % 2 == 0 || conditions == 1) return orders;
  // For an odd number, mirror images balance the followers.
  const std::size_t count = orders.size();
  for (std::size_t row = 0; row < count; ++row) {
    orders.emplace_back(orders[row].rbegin(), orders[row].rend());
  }
  return orders;
}

Design MakeDesign(const DesignOptions& options) {
  const auto methods = static_cast<int>(options.methods.size());
  DEMAND(options.operators >= 1 && options.layouts >= 1, options.operators, options.layouts);
  DEMAND(methods >= 1 && methods <= kOrientations, methods);
  Design design{
      .methods = options.methods, .rows = RowsOf(options), .layouts = ChooseLayouts(options)};
  const auto williams = WilliamsDesign(methods);
  const auto rows = static_cast<int>(williams.size());
  Random random(DeriveSeed(options.seed, kOrderSeed));
  const auto row_of = ChooseRows(options.operators, williams.size(), random);
  const auto width = std::max<std::size_t>(2, std::to_string(options.operators).size());
  for (int subject = 0; subject < options.operators; ++subject) {
    design.subjects.push_back(fmt::format("s{:0{}}", subject + 1, width));
    design.orders.emplace_back();
    for (int session = 0; session < methods; ++session) {
      const int method =
          williams[row_of[static_cast<std::size_t>(subject)]][static_cast<std::size_t>(session)];
      design.orders.back().push_back(options.methods[static_cast<std::size_t>(method)]);
      const auto tasks = Tasks(options.layouts, random);
      for (int task = 0; task < options.layouts; ++task) {
        const int layout = tasks[static_cast<std::size_t>(task)];
        PlannedEpisode episode{.subject = subject, .session = session, .task = task};
        episode.row = design.rows[static_cast<std::size_t>(method)];
        episode.maze_seed = design.layouts[static_cast<std::size_t>(layout)];
        episode.rotation_deg = 90 * ((session + layout + subject / rows) % methods);
        episode.seed = EpisodeSeed(options, design.episodes.size());
        episode.name = NameOf(episode, design.subjects.back());
        design.episodes.push_back(std::move(episode));
      }
    }
  }
  AddReferences(design, options);
  return design;
}

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

std::filesystem::path PersonPath(const std::string& subject) {
  return std::filesystem::path("people") / (subject + ".yaml");
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
  demo.search = options.search;
  demo.scenario = options.scenario;
  demo.recording = options.recording || options.h264;
  demo.streams = options.h264;
  demo.time_limit_s = options.time_limit_s;
  demo.out = options.out.empty() ? "runs" : options.out;
  return demo;
}

Result<void> CheckRange(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("{} {}: not between {} and {}", option, value, low, high));
}

Result<void> CheckJobs(int jobs) {
  if (auto ok = CheckRange("--jobs", jobs, 1, kMostJobs); !ok) return ok;
  if (jobs <= 1 || std::getenv("CONAV_DOMAIN") == nullptr) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--jobs {}: CONAV_DOMAIN leaves one DDS domain for all of them", jobs));
}

Result<void> Validate(const StudyOptions& options) {
  const DesignOptions& design = options.design;
  if (auto ok = CheckRange("--operators", design.operators, 1, kMostOperators); !ok) return ok;
  if (auto ok = CheckRange("--layouts", design.layouts, 1, kMostLayouts); !ok) return ok;
  if (auto ok = CheckJobs(options.jobs); !ok) return ok;
  if (auto ok = ValidatePopulation(options.population); !ok) return ok;
  if (options.h264 && options.camera != "egl") {
    return Fail(ErrorCode::kInvalidArgument, "--h264: needs --camera egl");
  }
  if (options.h264 && std::system("ffmpeg -version >/dev/null 2>&1") != 0) {
    return Fail(ErrorCode::kUnavailable, "--h264: ffmpeg is not installed");
  }
  launcher::DemoOptions demo = BaseDemo(options);
  if (auto ok = CheckRows(design); !ok) return ok;
  for (const StudyRow& row : RowsOf(design)) {
    demo.method = row.method;
    demo.communication = row.communication;
    demo.teleop_mps = row.teleop_mps;
    demo.search = SearchOf(row, options.search);
    if (auto ok = launcher::Validate(demo); !ok) return ok;
    if (auto ok = launcher::CheckSearch(demo); !ok) return ok;
  }
  for (const std::uint64_t layout : MakeDesign(design).layouts) {
    demo.maze_seed = layout;
    if (auto ok = launcher::CheckWorlds(demo); !ok) return ok;
  }
  return launcher::CheckWeights(demo);
}

}  // namespace conav::study
