#include "nhpm/commands/finished_weights.h"

#include <fmt/format.h>

#include <algorithm>

#include "nhpm/model/weights_file.h"
#include "nhpm/training/checkpoint.h"

namespace conav::nhpm {

Result<void> CheckReplaceable(const std::filesystem::path& out,
                              const std::map<std::string, std::string>& settings) {
  const auto finished = ReadWeightsFile(out);
  if (!finished && finished.error().code == ErrorCode::kNotFound) return {};
  if (!finished) {
    return Fail(ErrorCode::kRefused,
                fmt::format("{}; --overwrite replaces it", finished.error().text));
  }
  std::map<std::string, std::string> there;
  for (const auto& [name, value] : finished->training) {
    const bool of_adapting = std::ranges::find(kAdaptSettings, name) != std::end(kAdaptSettings);
    if (of_adapting || settings.contains(name)) there[name] = value;
  }
  const std::string difference = DifferenceText(there, settings);
  if (difference.empty()) return {};
  return Fail(ErrorCode::kRefused, fmt::format("{} holds weights of another training: {}; "
                                               "--overwrite replaces them",
                                               out.string(), difference));
}

}  // namespace conav::nhpm
