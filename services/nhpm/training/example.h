#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/encoding.h"

namespace conav::nhpm {

/// The target of an output. Masked ones (nothing to add where x has a wall, nothing to remove where
/// it has none, nothing on the border) are always 0.
enum class OutputLabel : std::uint8_t { kMasked, kKept, kEdited };

/// A segment as training data.
struct Example {
  std::vector<float> input;         // [rows][columns][kInputChannels], of EncodeInput
  std::vector<OutputLabel> labels;  // [rows][columns][kOutputChannels]: add, remove
  Cell camera;
  double heading_rad = 0.0;
  bool operator==(const Example&) const = default;
};

/// Examples of one shape.
struct ExampleSet {
  int rows = 0;
  int columns = 0;
  std::vector<Example> examples;
};

/// One network is trained on one size of map.
/// Errors: kInvalidArgument when maps differ in size.
[[nodiscard]] Result<void> CheckOneSize(const SegmentSet& segments);

/// All segments in order. Requires CheckSegments(segments) and CheckOneSize(segments).
ExampleSet ExamplesOf(const SegmentSet& segments, const InputSelection& inputs);

/// Share of the unmasked outputs that were edited, in (0, 1): with one added on either side.
double EditShare(const ExampleSet& set);

/// A segment file, prepared for training.
struct TrainingData {
  std::string checksum;  // SHA-256 of the file
  std::string origin;    // origin of the edits: OriginText
  std::size_t trajectories = 0;
  Fingerprints learned_from;  // of `train` and `validation`
  ExampleSet train;
  ExampleSet validation;
  ExampleSet test;
};

/// Splits by trajectory (SplitSegments).
/// Errors: those of ReadSegmentFile; kInvalidArgument: no segments, fewer than three trajectories,
/// maps of several sizes.
[[nodiscard]] Result<TrainingData> LoadTrainingData(const std::filesystem::path& file,
                                                    const InputSelection& inputs,
                                                    std::uint64_t split_seed);

}  // namespace conav::nhpm
