#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"

// One user: its command; the comparison on rasters is looked for by name.

/// The encoder-decoder against models for mazes, on test segments that are pasted on a canvas.
namespace conav::nhpm {

struct CanvasRow {
  RowLabel label;
  ModelIdentity identity;
  ModelMetrics test;  // edits and losses by pixel; the boundary is ideal on the test part
};

/// All models on the same pasted test segments (DrawPlacement, one seeded placement each, 150 x 150
/// pixels):
///
///   constant          the share of the train part's outputs that were edited, everywhere
///   those of `mazes`  their answers to the test segments, scaled up with the map: each pixel has
///                     its cell's probability, so distances count in the maze's cells
///   encoder_decoder   `model`, asked the pasted queries
///
/// Counts the pixels that can be edited: inside of the pasted map, not on its border or the
/// canvas's. All segments have one size.
/// Errors: those of Predict; kInvalidArgument: a probability that is not in [0, 1].
[[nodiscard]] Result<std::vector<CanvasRow>> EvaluateOnCanvas(const EvaluationData& data,
                                                              const std::vector<ModelRow>& mazes,
                                                              PerceptionModel& model);

/// For a terminal.
std::string CanvasTable(const std::vector<CanvasRow>& rows);

/// data: origin, file, sha256, test_segments; models by key: title, about, version, checksum,
/// mbce_all, mbce_unmasked, iou_best, iou_best_boundary, iou_fixed, ece, expected_edits_mean,
/// true_edits_mean (pixels a picture), edits_correlation.
nlohmann::ordered_json CanvasJson(const EvaluationData& data, const std::vector<CanvasRow>& rows);

}  // namespace conav::nhpm
