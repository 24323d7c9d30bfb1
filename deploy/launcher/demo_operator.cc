#include "launcher/demo_operator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace conav::launcher {

operators::SyntheticOperatorParameters OperatorPerson(const std::string& kind_or_file) {
  const auto& kinds = operators::OperatorKinds();
  if (std::find(kinds.begin(), kinds.end(), kind_or_file) != kinds.end()) {
    return operators::ParametersOfKind(kind_or_file);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(kind_or_file, ignored)) {
    throw StartupError(fmt::format("neither a file nor one of {}", fmt::join(kinds, ", ")));
  }
  constexpr const char* kSection = "simulated_operator";
  operators::SimulatedOperatorConfig config;
  ReadConfig(LoadParameters(kind_or_file, kSection), kSection, config);
  return config.person;
}

Result<void> CheckOperator(const DemoOptions& options) {
  try {
    OperatorPerson(options.simulated_operator);
    return {};
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--operator {}: {}", options.simulated_operator, error.what()));
  }
}

}  // namespace conav::launcher
