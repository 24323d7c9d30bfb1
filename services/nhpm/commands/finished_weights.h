#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/runtime/result.h"

namespace conav::nhpm {

/// Settings of `conav train --adapt` that the weights depend on, in NetworkModel::training.
inline constexpr const char* kAdaptSettings[] = {"base_checksum", "adapt_participant",
                                                 "adapt_data_sha256", "adapt_seed"};

/// Whether `conav train` may write to `out`: nothing is there, or the weights of a training with
/// the same settings. Errors: kRefused, naming what differs, or that it is no weights file.
[[nodiscard]] Result<void> CheckReplaceable(const std::filesystem::path& out,
                                            const std::map<std::string, std::string>& settings);

}  // namespace conav::nhpm
