#include "launcher/demo_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <sstream>

#include "common/cli/cli.h"
#include "common/msg/robot.h"

namespace conav::launcher {
namespace {

namespace fs = std::filesystem;

constexpr std::array kCommunications{"search", "never",        "random",
                                     "every",  "when_blocked", "threshold"};
constexpr std::array kCameras{"egl", "none"};
constexpr std::array kPerceptions{"remote", "embedded"};
constexpr std::array kXSources{"observed", "estimated"};
constexpr std::array kVendorChoices{"cyclonedds", "fastdds", "mixed", "SERVICE=VENDOR,..."};

bool IsService(const std::string& name) {
  return std::find(std::begin(kServices), std::end(kServices), name) != std::end(kServices);
}

Result<void> RequireRange(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("{} {}: not between {} and {}", option, value, low, high));
}

Result<void> RequireOneOf(const char* option, const std::string& value,
                          std::span<const char* const> choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {}: not one of {}", option, value, fmt::join(choices, ", ")));
}

Result<void> RequireFile(const char* option, const fs::path& file) {
  std::error_code ignored;
  const auto status = fs::status(file, ignored);
  if (file.empty() || fs::is_regular_file(status)) return {};
  const char* reason = fs::is_directory(status) ? "is a folder"
                       : fs::exists(status)     ? "is no file"
                                                : "no such file";
  return Fail(ErrorCode::kNotFound, fmt::format("{} {}: {}", option, file.string(), reason));
}

// The folder, or its nearest existing parent, must be writable for us.
Result<void> RequireWritable(const char* option, const fs::path& folder) {
  std::error_code error;
  fs::path place = fs::absolute(folder, error);
  while (!error && !fs::exists(place, error) && place.has_relative_path()) {
    place = place.parent_path();
  }
  if (fs::is_directory(place, error) && access(place.c_str(), W_OK | X_OK) == 0) return {};
  return Fail(ErrorCode::kIo,
              fmt::format("{} {}: cannot write to {}", option, folder.string(), place.string()));
}

Result<void> ValidateFiles(const DemoOptions& options) {
  if (!options.operator_map.empty() && options.map.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--operator-map: needs --map, the true plan");
  }
  if (options.cell_size_m && options.map.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--cell-size: needs --map");
  }
  if (auto ok = RequireFile("--map", options.map); !ok) return ok;
  if (auto ok = RequireFile("--operator-map", options.operator_map); !ok) return ok;
  if (auto ok = RequireFile("--weights", options.weights); !ok) return ok;
  if (!options.person.empty() && !fs::is_directory(options.person_weights)) {
    return Fail(ErrorCode::kNotFound, fmt::format("--person-weights {}: no such folder",
                                                  options.person_weights.string()));
  }
  if (auto ok = CheckDistinct({{"--map", options.map},
                               {"--operator-map", options.operator_map},
                               {"--weights", options.weights}},
                              {{"--json", options.json}});
      !ok) {
    return ok;
  }
  if (!options.json.empty()) {
    const fs::path folder = fs::absolute(options.json).parent_path();
    if (!fs::is_directory(folder)) {
      return Fail(ErrorCode::kIo,
                  fmt::format("--json {}: no folder {}", options.json.string(), folder.string()));
    }
    if (fs::is_directory(options.json)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--json {}: is a folder", options.json.string()));
    }
    if (auto ok = RequireWritable("--json", folder); !ok) return ok;
  }
  return RequireWritable("--out", options.out);
}

Result<void> ValidatePerson(const DemoOptions& options) {
  if (options.person.empty() != options.person_weights.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--person and --person-weights only work together");
  }
  if (options.person.empty()) return {};
  if (!IsEntityName(options.person)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--person {}: is not 1 to {} of A-Z a-z 0-9 _", options.person, kMaxName));
  }
  if (options.model == PerceptionModelKind::kGlpf) {
    return Fail(ErrorCode::kInvalidArgument, "--person: --model glpf has no models of persons");
  }
  if (options.perception == "embedded") {
    return Fail(ErrorCode::kInvalidArgument,
                "--person: not with --perception embedded; pass the person's file as --weights");
  }
  return {};
}

/// Rejects options that another option makes meaningless.
Result<void> ValidateUses(const DemoOptions& options) {
  if (options.model == PerceptionModelKind::kGlpf && !options.weights.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--weights: --model glpf has no weights");
  }
  if (options.perception == "embedded" && options.nhpm_replicas > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--nhpm-replicas {}: --perception embedded does not use them",
                            options.nhpm_replicas));
  }
  if (options.planners > 1 && options.x_source == "estimated") {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--planners {}: --x-source estimated would only see the pictures of "
                            "each planner's own robots",
                            options.planners));
  }
  if (options.streams && !options.recording) {
    return Fail(ErrorCode::kInvalidArgument, "--streams: not with --no-recording");
  }
  if (options.method != MethodKind::kIgMcts && options.communication != "search") {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--communication {}: --method {} does not ask for answers to pictures",
                            options.communication, Name(options.method)));
  }
  return ValidatePerson(options);
}

Result<void> ValidateNumbers(const DemoOptions& options) {
  if (auto ok = RequireRange("--robots", options.robots, 1, kMaxRobots); !ok) return ok;
  if (auto ok = RequireRange("--worlds", options.worlds, 1, kMaxWorlds); !ok) return ok;
  if (auto ok = RequireRange("--nhpm-replicas", options.nhpm_replicas, 1, kMaxReplicas); !ok) {
    return ok;
  }
  if (auto ok = RequireRange("--planners", options.planners, 1, kMaxPlanners); !ok) return ok;
  if (auto ok = RequireRange("--speed", options.effective_speed(), 0, 1000); !ok) return ok;
  if (auto ok = RequireRange("--rotation", options.rotation_deg, 0, 270); !ok) return ok;
  if (auto ok = RequireRange("--domain", options.domain.value_or(0), 0, 232); !ok) return ok;
  if (auto ok = RequireRange("--cell-size", options.cell_size_m.value_or(1), 1, 100); !ok) {
    return ok;
  }
  return RequireRange("--time-limit", options.time_limit_s.value_or(1.0), 1, 1e6);
}

}  // namespace

Result<void> Validate(const DemoOptions& options) {
  if (auto ok = ValidateNumbers(options); !ok) return ok;
  if (options.rotation_deg % 90 != 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--rotation {}: not one of 0, 90, 180, 270", options.rotation_deg));
  }
  if (auto ok = RequireOneOf("--communication", options.communication, kCommunications); !ok) {
    return ok;
  }
  if (auto ok = RequireOneOf("--camera", options.camera, kCameras); !ok) return ok;
  if (auto ok = RequireOneOf("--perception", options.perception, kPerceptions); !ok) return ok;
  if (auto ok = RequireOneOf("--x-source", options.x_source, kXSources); !ok) return ok;
  if (auto ok = ValidateUses(options); !ok) return ok;
  if (auto vendors = VendorOfService(options.dds); !vendors) {
    return tl::unexpected<Error>(vendors.error());
  }
  return ValidateFiles(options);
}

Result<std::pair<std::string, std::string>> ParseRunWith(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || text.find_first_not_of(' ', equals + 1) == std::string::npos) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--run-with {}: expected SERVICE=COMMAND", text));
  }
  const std::string service = text.substr(0, equals);
  if (!IsService(service)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--run-with {}: '{}' is not one of {}", text, service,
                            fmt::join(kServices, ", ")));
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
  if (dds.find('=') == std::string::npos) {
    if (auto ok = RequireOneOf("--dds", dds, kVendorChoices); !ok) {
      return tl::unexpected<Error>(ok.error());
    }
    for (auto& [service, vendor] : vendors) vendor = bus::ParseVendor(dds);
    return vendors;
  }
  std::istringstream list(dds);
  for (std::string entry; std::getline(list, entry, ',');) {
    const auto equals = entry.find('=');
    const std::string service = entry.substr(0, equals);
    if (equals == std::string::npos || vendors.count(service) == 0) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--dds {}: '{}' is not SERVICE=VENDOR; services: {}, launcher", dds,
                              entry, fmt::join(kServices, ", ")));
    }
    const std::string vendor = entry.substr(equals + 1);
    vendors[service] = bus::ParseVendor(vendor);
    if (!vendors[service]) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("--dds {}: not one of {}", vendor,
                                                           fmt::join(Names(bus::kVendors), ", ")));
    }
  }
  return vendors;
}

}  // namespace conav::launcher
