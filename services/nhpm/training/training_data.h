#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/trajectory_fingerprint.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {

/// A segment file, ready to learn from.
struct TrainingData {
  std::string checksum;  // SHA-256 of the file
  std::string origin;    // who made the edits: OriginText
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
