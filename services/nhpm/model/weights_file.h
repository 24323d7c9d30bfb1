#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "nhpm/engine/network_weights.h"
#include "nhpm/model/encoding.h"

namespace conav::nhpm {

/// A network as it is kept on disk and served.
struct NetworkModel {
  std::string name = kNhpmModel;
  std::string version;  // for people: what it was trained on, when
  NetworkWeights weights;
  InputSelection inputs;
  /// The only grid size that it answers for; 0 = any.
  int rows = 0;
  int columns = 0;
  /// Who made the edits that it learned: "synthetic", "simulated", "people", or several with "+".
  std::string data_origin;
  /// The training configuration and its results, by name.
  std::map<std::string, std::string> training;
  /// FingerprintOf the trajectories that it learned from, those that decided when to stop too;
  /// ascending. None = not known.
  std::vector<std::uint64_t> learned_from;
  bool operator==(const NetworkModel&) const = default;
};

/// SHA-256 over shape, input selection, grid size, weights and biases (as little-endian bytes in
/// the order of NetworkWeights): equal checksums, equal answers. 64 hexadecimal digits.
std::string ChecksumOf(const NetworkModel& model);

/// Writes beside `path` and renames, so that a reader sees the old file or the new one.
/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteWeightsFile(const std::filesystem::path& path,
                                            const NetworkModel& model);

/// Errors, each with path and what is wrong: kNotFound; kIo; kMalformed (no weights file, truncated,
/// another format version, checksum differs, wrong number of values, a value that is not finite).
[[nodiscard]] Result<NetworkModel> ReadWeightsFile(const std::filesystem::path& path);

/// The warning of weights whose file does not say which trajectories they learned from.
std::string UnknownLearning(const std::filesystem::path& weights);

}  // namespace conav::nhpm
