#include "study/live/task_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "common/msg/method.h"
#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "launcher/demo_plan.h"
#include "planner/config.h"
#include "study/design.h"

namespace conav::mapping_task {
namespace {

constexpr std::size_t kLongestCode = 40;
/// The methods that involve a person.
constexpr std::array kStudyMethods{"ig-mcts", "instruction", "teleop"};
constexpr int kMostMazes = 100;
constexpr std::uint64_t kSeedRange = 1'000'000'000;  // people can read these seeds out

bool IsCodeLetter(char letter) {
  return (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z') ||
         (letter >= '0' && letter <= '9') || letter == '_' || letter == '-';
}

std::uint64_t NumberOf(const std::string& participant) {
  return std::stoull(Sha256Hex(participant).substr(0, 16), nullptr, 16);
}

Result<void> CheckMazes(const TaskOptions& options) {
  if (options.mazes < 1 || options.mazes > kMostMazes) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("--mazes {}: not between 1 and {}", options.mazes, kMostMazes));
  }
  const auto given = static_cast<int>(options.maze_seeds.size());
  if (given == 0 || given == options.mazes) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--maze-seed: {} seeds for {} mazes", given, options.mazes));
}

Result<void> CheckMethods(const TaskOptions& options) {
  for (const std::string& method : options.methods) {
    if (std::ranges::find(kStudyMethods, method) != kStudyMethods.end()) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--methods: {} is not one of {}", method,
                                                         fmt::join(kStudyMethods, ", ")));
  }
  for (const std::string& method : options.methods) {
    if (std::ranges::count(options.methods, method) == 1) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--methods: {} is named twice", method));
  }
  if (!options.is_study() || static_cast<int>(options.methods.size()) == options.mazes) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("--methods: {} methods for {} mazes",
                                                       options.methods.size(), options.mazes));
}

}  // namespace

bool IsParticipantCode(const std::string& code) {
  return !code.empty() && code.size() <= kLongestCode && std::ranges::all_of(code, IsCodeLetter);
}

std::filesystem::path FolderOf(const TaskOptions& options) {
  if (!options.out.empty()) return options.out;
  return (options.is_study() ? "runs/study-" : "runs/mapping-") + options.participant;
}

Result<std::vector<std::string>> MethodsInOrder(const std::vector<std::string>& methods, int order,
                                                const std::string& participant) {
  const auto orders = study::WilliamsDesign(static_cast<int>(methods.size()));
  if (order < 0 || order > static_cast<int>(orders.size())) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("--order {}: not between 1 and {}", order, orders.size()));
  }
  const std::size_t row =
      order > 0 ? static_cast<std::size_t>(order) - 1 : NumberOf(participant) % orders.size();
  std::vector<std::string> ordered;
  for (const int index : orders[row]) ordered.push_back(methods[static_cast<std::size_t>(index)]);
  return ordered;
}

std::string MethodOf(const TaskOptions& options, int number) {
  if (!options.is_study()) return std::string(Name(MethodKind::kMapping));
  return options.methods.at(static_cast<std::size_t>(number) - 1);
}

std::vector<std::uint64_t> SeedsOf(const TaskOptions& options) {
  if (!options.maze_seeds.empty()) return options.maze_seeds;
  const std::uint64_t own = DeriveSeed(options.seed, NumberOf(options.participant));
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < options.mazes; ++i) {
    seeds.push_back(DeriveSeed(own, static_cast<std::uint64_t>(i)) % kSeedRange);
  }
  return seeds;
}

nlohmann::ordered_json DesignOf(const TaskOptions& options) {
  nlohmann::ordered_json design{{"participant", options.participant},
                                {"preset", options.preset},
                                {"maze_seeds", SeedsOf(options)}};
  if (options.is_study()) design["methods"] = options.methods;
  return design;
}

launcher::DemoOptions DemoOf(const TaskOptions& options, std::uint64_t maze_seed) {
  launcher::DemoOptions demo;
  demo.seed = maze_seed;
  demo.preset = options.preset;
  demo.camera = options.camera;
  demo.speed = options.speed;
  demo.dds = options.dds;
  demo.domain = options.domain;
  demo.console = options.port;
  demo.out = FolderOf(options);
  return demo;
}

Result<void> Validate(const TaskOptions& options) {
  if (!IsParticipantCode(options.participant)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--participant '{}': not 1 to {} of A-Z a-z 0-9 _ -",
                            options.participant, kLongestCode));
  }
  if (auto ok = CheckMazes(options); !ok) return ok;
  if (auto ok = CheckMethods(options); !ok) return ok;
  if (options.speed <= 0.0) {
    return Fail(ErrorCode::kOutOfRange, fmt::format("--speed {}: not above 0", options.speed));
  }
  for (const std::uint64_t seed : SeedsOf(options)) {
    const launcher::DemoOptions demo = DemoOf(options, seed);
    if (auto ok = launcher::Validate(demo); !ok) return ok;
    if (auto ok = launcher::CheckWorlds(demo); !ok) return ok;
  }
  return {};
}

}  // namespace conav::mapping_task
