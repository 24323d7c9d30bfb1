#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/msg/perception_model.h"
#include "common/runtime/result.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// The weights that come with conav: ../share/conav/models/default.nhpm as seen from the folder of
/// the running program.
std::filesystem::path ShippedWeights();

/// The file itself, or the shipped one where `weights` is empty.
std::filesystem::path WeightsOrShipped(const std::filesystem::path& weights);

/// kGlpfModel from `glpf`, or kNhpmModel from a weights file; empty `weights` = ShippedWeights().
/// Errors: kInvalidArgument (another name), those of ReadWeightsFile.
[[nodiscard]] Result<std::shared_ptr<PerceptionModel>> LoadPerceptionModel(
    const std::string& name, const std::filesystem::path& weights, const GlpfParameters& glpf);

}  // namespace conav::nhpm
