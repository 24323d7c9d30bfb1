#include "study/supervision_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include "operator/attention/attention_order.h"
#include "study/run_pieces.h"

namespace conav::study {
namespace {

Result<void> Refuse(std::string text) { return Fail(ErrorCode::kInvalidArgument, std::move(text)); }

Result<void> CheckNames(const std::string& option, const std::vector<std::string>& given,
                        const std::vector<std::string>& known) {
  if (given.empty()) return Refuse(option + ": names none");
  for (const std::string& name : given) {
    if (std::ranges::count(given, name) > 1) {
      return Refuse(fmt::format("{}: {} is named twice", option, name));
    }
    if (std::ranges::find(known, name) == known.end()) {
      return Refuse(
          fmt::format("{}: {} is unknown; there are {}", option, name, fmt::join(known, ", ")));
    }
  }
  return {};
}

Result<void> CheckRobots(const std::vector<int>& robots) {
  if (robots.empty()) return Refuse("--robots: names none");
  for (const int count : robots) {
    if (count < 1 || count > kMostSupervised) {
      return Refuse(fmt::format("--robots: {} is not in [1, {}]", count, kMostSupervised));
    }
    if (std::ranges::count(robots, count) > 1) {
      return Refuse(fmt::format("--robots: {} is named twice", count));
    }
  }
  return {};
}

Result<void> CheckRange(const std::string& option, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Refuse(fmt::format("{}: {} is not in [{}, {}]", option, value, low, high));
}

}  // namespace

std::filesystem::path DefaultSupervisionOut(const std::string& fingerprint) {
  return fmt::format("runs/supervision-{:.8}", fingerprint);
}

Result<void> ParseInteractionTimes(const std::string& text,
                                   operators::InteractionTimeParameters& times) {
  const std::map<std::string, double*> places{{"picture", &times.picture_s},
                                              {"blocked", &times.blocked_s},
                                              {"path", &times.path_s},
                                              {"log_sd", &times.log_sd}};
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    const auto place = places.find(part.substr(0, equals));
    double value = 0.0;
    const char* end = part.data() + part.size();
    const char* begin = equals == std::string::npos ? end : part.data() + equals + 1;
    const auto parsed = std::from_chars(begin, end, value);
    const bool is_time = begin != end && parsed.ec == std::errc{} && parsed.ptr == end;
    if (place == places.end() || !is_time || !(value >= 0.0 && value <= 3600.0)) {
      return Refuse(fmt::format(
          "--interaction-times: \"{}\" is not picture=S, blocked=S, path=S or log_sd=X, S in "
          "seconds up to 3600",
          part));
    }
    *place->second = value;
  }
  return {};
}

Result<void> Validate(const SupervisionOptions& options) {
  if (auto ok = CheckRobots(options.robots); !ok) return ok;
  if (auto ok = CheckNames("--orders", options.orders, operators::AttentionOrders()); !ok) {
    return ok;
  }
  if (auto ok = CheckNames("--methods", options.methods, {"ig-mcts", "instruction"}); !ok) {
    return ok;
  }
  for (const auto& [option, value, low, high] :
       {std::tuple{"--seeds", static_cast<double>(options.seeds), 1.0, 10000.0},
        std::tuple{"--minutes", options.minutes, 0.1, 600.0},
        std::tuple{"--goals", static_cast<double>(options.goals), 1.0, 100.0},
        std::tuple{"--robots-per-world", static_cast<double>(options.robots_per_world), 1.0, 16.0},
        std::tuple{"--answer-timeout", options.answer_timeout_s, 1.0, 3600.0},
        std::tuple{"--speed", options.speed, 0.1, 1000.0},
        std::tuple{"--jobs", static_cast<double>(options.jobs), 1.0, 64.0}}) {
    if (auto ok = CheckRange(option, value, low, high); !ok) return ok;
  }
  if (!options.dds.empty()) {
    if (auto ok = CheckNames("--dds", {options.dds}, {"cyclonedds", "fastdds"}); !ok) return ok;
  }
  return CheckDomains(options.jobs);
}

std::string SupervisionTrial::name() const {
  return fmt::format("n{:02}-{}-seed{}", robots, order, seed);
}

std::vector<SupervisionTrial> TrialsOf(const SupervisionOptions& options) {
  std::vector<SupervisionTrial> trials;
  for (int i = 0; i < options.seeds; ++i) {
    for (const int robots : options.robots) {
      for (const std::string& order : options.orders) {
        trials.push_back({robots, order, options.seed + static_cast<std::uint64_t>(i)});
      }
    }
  }
  return trials;
}

}  // namespace conav::study
