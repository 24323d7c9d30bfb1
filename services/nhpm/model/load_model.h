#pragma once

#include <filesystem>
#include <memory>

#include "common/msg/perception_model.h"
#include "common/runtime/result.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// The weights that come with conav: ../share/conav/models/default.nhpm as seen from the folder of
/// the running program.
std::filesystem::path ShippedWeights();

/// The file itself, or the shipped one where `weights` is empty.
std::filesystem::path WeightsOrShipped(const std::filesystem::path& weights);

/// The GLPF from `glpf`, or the network from a weights file; empty `weights` = ShippedWeights().
/// Errors: those of ReadWeightsFile.
[[nodiscard]] Result<std::shared_ptr<PerceptionModel>> LoadPerceptionModel(
    PerceptionModelKind kind, const std::filesystem::path& weights, const GlpfParameters& glpf);

}  // namespace conav::nhpm
