#pragma once

#include <filesystem>
#include <memory>

#include "common/msg/perception_model.h"
#include "common/runtime/result.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// The weights that come with conav: ../share/conav/models/default.nhpm as seen from the folder of
/// the running program, or encoder-decoder.nhpm.
std::filesystem::path ShippedWeights(PerceptionModelKind kind = PerceptionModelKind::kNhpm);

/// The file itself, or the shipped one where `weights` is empty.
std::filesystem::path WeightsOrShipped(const std::filesystem::path& weights,
                                       PerceptionModelKind kind = PerceptionModelKind::kNhpm);

/// The GLPF from `glpf`, or a network from a weights file; empty `weights` = ShippedWeights(kind).
/// Errors: those of ReadWeightsFile; kInvalidArgument: the file holds the other kind of network.
[[nodiscard]] Result<std::shared_ptr<PerceptionModel>> LoadPerceptionModel(
    PerceptionModelKind kind, const std::filesystem::path& weights, const GlpfParameters& glpf);

}  // namespace conav::nhpm
