#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/runtime/result.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// The saved state of a training, for resuming after a kill.
struct Checkpoint {
  /// Options, data and inputs by name; a resuming training must have the same.
  std::map<std::string, std::string> settings;
  TrainingState state;
  bool operator==(const Checkpoint&) const = default;
};

/// Writes a temporary file next to `path` and renames it: a kill at any moment leaves the last
/// checkpoint or the new one. Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteCheckpoint(const std::filesystem::path& path,
                                           const Checkpoint& checkpoint);

/// Errors, each with path and reason: kNotFound; kIo; kMalformed (no checkpoint, cut off, damaged,
/// another format version, wrong counts, values that are not finite).
[[nodiscard]] Result<Checkpoint> ReadCheckpoint(const std::filesystem::path& path);

/// Names each setting that differs: "seed 1 there, 2 now; width 32 there, 64 now". Empty = equal.
std::string DifferenceText(const std::map<std::string, std::string>& there,
                           const std::map<std::string, std::string>& now);

}  // namespace conav::nhpm
