#include "launcher/demo_options.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <sstream>

#include "common/cli/cli.h"
#include "common/msg/robot.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "sim/world/world_spec.h"

namespace conav::launcher {
namespace {

namespace fs = std::filesystem;

constexpr std::array kCommunications{"search", "never",        "random",
                                     "every",  "when_blocked", "threshold"};
constexpr std::array kWorlds{"maze", "waterway"};
constexpr std::array kCameras{"egl", "none"};
constexpr std::array kPerceptions{"remote", "embedded"};
constexpr std::array kXSources{"observed", "estimated", "none"};
constexpr std::array kVendorChoices{"cyclonedds", "fastdds", "mixed", "SERVICE=VENDOR,..."};

bool IsService(const std::string& name) {
  return std::find(std::begin(kServices), std::end(kServices), name) != std::end(kServices);
}

/// Keeps the first thing that is wrong with a command line.
class Checks {
 public:
  template <class... Values>
  void Refuse(bool wrong, fmt::format_string<Values...> reason, Values&&... values) {
    if (wrong)
      Keep(ErrorCode::kInvalidArgument, fmt::format(reason, std::forward<Values>(values)...));
  }

  void Range(const char* option, double value, double low, double high) {
    if (value >= low && value <= high) return;
    Keep(ErrorCode::kOutOfRange,
         fmt::format("{} {}: not between {} and {}", option, value, low, high));
  }

  void OneOf(const char* option, const std::string& value, std::span<const char* const> choices) {
    Refuse(std::ranges::find(choices, value) == choices.end(), "{} {}: not one of {}", option,
           value, Join(choices, ", "));
  }

  void File(const char* option, const fs::path& file) {
    if (file.empty()) return;
    const auto readable = CheckReadable(file);
    if (!readable) Keep(readable.error().code, fmt::format("{} {}", option, readable.error().text));
  }

  /// The folder, or its nearest existing parent, must be writable for us.
  void Writable(const char* option, const fs::path& folder) {
    std::error_code error;
    fs::path place = fs::absolute(folder, error);
    while (!error && !fs::exists(place, error) && place.has_relative_path()) {
      place = place.parent_path();
    }
    if (fs::is_directory(place, error) && access(place.c_str(), W_OK | X_OK) == 0) return;
    Keep(ErrorCode::kIo,
         fmt::format("{} {}: cannot write to {}", option, folder.string(), place.string()));
  }

  void Keep(ErrorCode code, std::string text) {
    if (result_) result_ = Fail(code, std::move(text));
  }
  Result<void> Take() { return std::move(result_); }

 private:
  Result<void> result_;
};

void CheckNumbers(const DemoOptions& options, Checks& checks) {
  checks.Range("--robots", options.robots, 1, kMaxRobots);
  checks.Range("--mapping-value", options.mapping_value.value_or(1.0), 0, 1e6);
  checks.Range("--worlds", options.worlds, 1, kMaxWorlds);
  checks.Range("--nhpm-replicas", options.nhpm_replicas, 1, kMaxReplicas);
  checks.Range("--planners", options.planners, 1, kMaxPlanners);
  checks.Range("--speed", options.effective_speed(), 0, 1000);
  checks.Range("--rotation", options.rotation_deg, 0, 270);
  checks.Range("--domain", options.domain.value_or(0), 0, 232);
  checks.Range("--cell-size", options.cell_size_m.value_or(1), 0.1, 100);
  checks.Range("--water-level", options.water_level.value_or(1), 0, 65535);
  checks.Range("--resolution", options.resolution_m.value_or(1), 0.001, 1000);
  checks.Range("--radius", options.robot_radius_m.value_or(1), sim::kMinRobotRadiusM,
               sim::kMaxRobotRadiusM);
  checks.Range("--teleop-speed", options.teleop_mps.value_or(1), 0.1, 2);
  checks.Range("--time-limit", options.time_limit_s.value_or(1.0), 1, 1e6);
  checks.Refuse(options.rotation_deg % 90 != 0, "--rotation {}: not one of 0, 90, 180, 270",
                options.rotation_deg);
}

/// Rejects options that another option makes meaningless.
void CheckUses(const DemoOptions& options, Checks& checks) {
  const bool embedded = options.perception == "embedded";
  const bool learned = options.effective_model() != PerceptionModelKind::kGlpf;
  checks.Refuse(!learned && !options.weights.empty(), "--weights: --model {} has no weights",
                Name(options.effective_model()));
  checks.Refuse(options.model == PerceptionModelKind::kAuto && options.is_open(),
                "--model auto: pools models of mazes");
  checks.Refuse(embedded && options.nhpm_replicas > 1,
                "--nhpm-replicas {}: --perception embedded does not use them",
                options.nhpm_replicas);
  checks.Refuse(options.planners > 1 && options.x_source != "observed",
                "--planners {}: --x-source {} would only see the pictures of each "
                "planner's own robots",
                options.planners, options.x_source);
  checks.Refuse(
      options.method != MethodKind::kIgMcts && (!options.search.empty() || options.mapping_value),
      "--search, --mapping-value: --method {} does not search", Name(options.method));
  checks.Refuse(!options.scenario.empty() && (options.is_open() || !options.map.empty()),
                "--scenario {}: a scenario has its own maze", options.scenario);
  checks.Refuse(!options.scenario.empty() && (options.preset != DemoOptions{}.preset ||
                                              options.x_source != DemoOptions{}.x_source),
                "--scenario {}: a scenario has its own --preset and --x-source", options.scenario);
  const bool drives_anywhere =
      options.method == MethodKind::kIgMcts || options.method == MethodKind::kGreedy;
  checks.Refuse(options.is_open() && !drives_anywhere,
                "--method {}: open terrain has ig-mcts and greedy", Name(options.method));
  checks.Refuse(options.robot_radius_m && !options.is_open(),
                "--radius: in mazes and on cells of 1 m or more it is 0.2 m; smaller cells "
                "(--cell-size) or --world waterway make the terrain open");
  checks.Refuse(options.is_waterway() && options.preset != DemoOptions{}.preset,
                "--preset {}: --world waterway has no mazes", options.preset);
  checks.Refuse(options.streams && !options.recording, "--streams: not with --no-recording");
  checks.Refuse(options.method != MethodKind::kIgMcts && options.communication != "search",
                "--communication {}: --method {} does not ask for answers to pictures",
                options.communication, Name(options.method));
  checks.Refuse(options.person.empty() != options.person_weights.empty(),
                "--person and --person-weights only work together");
  if (options.person.empty()) return;
  checks.Refuse(!IsEntityName(options.person), "--person {}: is not 1 to {} of A-Z a-z 0-9 _",
                options.person, kMaxName);
  checks.Refuse(Served(options.effective_model()) != PerceptionModelKind::kNhpm,
                "--person: --model {} has no models of persons", Name(options.effective_model()));
  checks.Refuse(embedded,
                "--person: not with --perception embedded; pass the person's file as --weights");
}

void CheckPaths(const DemoOptions& options, Checks& checks) {
  checks.Refuse(!options.operator_map.empty() && options.map.empty(),
                "--operator-map: needs --map, the true plan");
  checks.Refuse(options.cell_size_m && options.map.empty(), "--cell-size: needs --map");
  const bool image = options.has_height_map();
  checks.Refuse(options.water_level && !image, "--water-level: needs --map with a height map");
  checks.Refuse(options.resolution_m && !image,
                "--resolution: needs --map with a height map; a map_server file has its own");
  checks.Refuse(image && !options.operator_map.empty(),
                "--operator-map: needs a map_server file as --map; a height map is made outdated "
                "with the seed");
  checks.File("--map", options.map);
  checks.File("--operator-map", options.operator_map);
  checks.File("--weights", options.weights);
  checks.Refuse(!options.person.empty() && !fs::is_directory(options.person_weights),
                "--person-weights {}: no such folder", options.person_weights.string());
  const auto distinct = CheckDistinct({{"--map", options.map},
                                       {"--operator-map", options.operator_map},
                                       {"--weights", options.weights}},
                                      {{"--json", options.json}});
  if (!distinct) checks.Keep(distinct.error().code, distinct.error().text);
  if (!options.json.empty()) {
    const fs::path folder = fs::absolute(options.json).parent_path();
    checks.Refuse(!fs::is_directory(folder), "--json {}: no folder {}", options.json.string(),
                  folder.string());
    checks.Refuse(fs::is_directory(options.json), "--json {}: is a folder", options.json.string());
    checks.Writable("--json", folder);
  }
  checks.Writable("--out", options.out);
}

}  // namespace

bool DemoOptions::has_height_map() const {
  return !map.empty() && map.extension() != ".yaml" && map.extension() != ".yml";
}

bool DemoOptions::is_open() const {
  return is_waterway() || has_height_map() || cell_size_m.value_or(1.0) < 1.0;
}

Result<void> Validate(const DemoOptions& options) {
  Checks checks;
  CheckNumbers(options, checks);
  checks.OneOf("--communication", options.communication, kCommunications);
  checks.OneOf("--world", options.world, kWorlds);
  checks.OneOf("--camera", options.camera, kCameras);
  checks.OneOf("--perception", options.perception, kPerceptions);
  checks.OneOf("--x-source", options.x_source, kXSources);
  CheckUses(options, checks);
  const auto vendors = VendorOfService(options.dds);
  if (!vendors) checks.Keep(vendors.error().code, vendors.error().text);
  CheckPaths(options, checks);
  return checks.Take();
}

Result<std::pair<std::string, std::string>> ParseRunWith(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || text.find_first_not_of(' ', equals + 1) == std::string::npos) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--run-with {}: expected SERVICE=COMMAND", text));
  }
  const std::string service = text.substr(0, equals);
  if (!IsService(service)) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--run-with {}: '{}' is not one of {}",
                                                         text, service, Join(kServices, ", ")));
  }
  return std::pair(service, text.substr(equals + 1));
}

Result<std::map<std::string, std::optional<bus::Vendor>>> VendorOfService(const std::string& dds) {
  std::map<std::string, std::optional<bus::Vendor>> vendors{{"launcher", std::nullopt}};
  for (const char* service : kServices) vendors[service] = std::nullopt;
  if (dds.empty()) return vendors;
  if (dds == "mixed") {
    std::size_t turn = 0;
    for (auto& [service, vendor] : vendors) {
      vendor = bus::kVendors[service == "recorder" ? 0 : turn++ % bus::kVendors.size()];
    }
    return vendors;
  }
  Checks checks;
  if (dds.find('=') == std::string::npos) {
    checks.OneOf("--dds", dds, kVendorChoices);
    for (auto& [service, vendor] : vendors) vendor = bus::ParseVendor(dds);
    return checks.Take().map([&] { return vendors; });
  }
  std::istringstream list(dds);
  for (std::string entry; std::getline(list, entry, ',');) {
    const auto equals = entry.find('=');
    const std::string service = entry.substr(0, equals);
    checks.Refuse(equals == std::string::npos || vendors.count(service) == 0,
                  "--dds {}: '{}' is not SERVICE=VENDOR; services: {}, launcher", dds, entry,
                  Join(kServices, ", "));
    const std::string vendor = equals == std::string::npos ? "" : entry.substr(equals + 1);
    vendors[service] = bus::ParseVendor(vendor);
    checks.Refuse(!vendors[service], "--dds {}: not one of {}", vendor,
                  Join(Names(bus::kVendors), ", "));
  }
  return checks.Take().map([&] { return vendors; });
}

}  // namespace conav::launcher
