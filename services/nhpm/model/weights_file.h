#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "nhpm/engine/network_weights.h"
#include "nhpm/model/encoding.h"
#include "weights.pb.h"

namespace conav::nhpm {

/// The beginning of a file of a given kind.
struct FrameKind {
  std::string_view magic;  // 4 characters
  std::uint32_t version = 1;
  std::string_view name;  // for messages: "weights file"
};

/// Wraps a payload in a frame that detects damage:
///
///   magic  version  payload size  SHA-256 of the payload  payload
///   4      4        8             64 hexadecimal digits   (bytes; numbers little-endian)
std::string Frame(const FrameKind& kind, std::string_view payload);

/// The payload within `bytes`. Errors: kMalformed, with the reason: not of this kind, cut off, too
/// long, another version, another SHA-256.
[[nodiscard]] Result<std::string_view> Unframe(const FrameKind& kind, std::string_view bytes);

/// Adds one message per layer.
void AddLayers(const NetworkWeights& weights,
               google::protobuf::RepeatedPtrField<proto::Layer>& layers);

/// As stored; ArchitectureFrom gives kMalformed for a number from a later version.
proto::Architecture ToMessage(Architecture architecture);
[[nodiscard]] Result<Architecture> ArchitectureFrom(proto::Architecture message);

/// The weights of a network of that width.
/// Errors: kMalformed: unknown width, wrong number of layers, weights or biases, a value that is
///         not finite; names the layer, the actual and the expected number.
[[nodiscard]] Result<NetworkWeights> WeightsFrom(
    std::uint32_t width, Architecture architecture,
    const google::protobuf::RepeatedPtrField<proto::Layer>& layers);

/// Serialises the message so that equal messages give equal bytes.
std::string BytesOf(const google::protobuf::Message& message);

/// A network as stored on disk and served.
struct NetworkModel {
  std::string name{Name(PerceptionModelKind::kNhpm)};
  std::string version;  // for people: what it was trained on, when
  NetworkWeights weights;
  InputSelection inputs;
  /// The only grid size that it supports; 0 = any.
  int rows = 0;
  int columns = 0;
  /// The origin of the edits it learned: "synthetic", "simulated", "people", or several with "+".
  std::string data_origin;
  /// The training configuration and its results, by name.
  std::map<std::string, std::string> training;
  /// FingerprintOf the trajectories it learned from, including those for early stopping; ascending.
  /// Empty = unknown.
  std::vector<std::uint64_t> learned_from;
  bool operator==(const NetworkModel&) const = default;
};

/// SHA-256 over shape (of an encoder-decoder: also the number of layers), input selection, grid size, weights and biases (as little-endian bytes in
/// the order of NetworkWeights): equal checksums, equal answers. 64 hexadecimal digits.
std::string ChecksumOf(const NetworkModel& model);

/// Writes a temporary file next to `path` and renames it, so that a reader sees the old file or the
/// new one.
/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteWeightsFile(const std::filesystem::path& path,
                                            const NetworkModel& model);

/// Errors, each with path and reason: kNotFound; kIo; kMalformed (no weights file, truncated,
/// another format version, checksum differs, wrong number of values, a value that is not finite).
[[nodiscard]] Result<NetworkModel> ReadWeightsFile(const std::filesystem::path& path);

/// The convolutional network as an ONNX model: 3x3 convolutions, ReLU between them, a sigmoid at the end.
///
///   input          "input"          float [batch, kInputChannels, rows, columns], as EncodeInput
///                                   has it, but channels before rows; channels 2 and 3 hold
///                                   nearness, 1 - depth / 10 cells in [0.2, 1], not 0 or 1
///   output         "probabilities"  float [batch, kOutputChannels, rows, columns]: add, remove
///
/// The model does not contain the masks: its user multiplies add by (1 - x), remove by x, and both
/// by 0 on the border. Rows and columns are open if the network fits any size; the batch always is.
/// The model's metadata has name, version, checksum, origin of the data and inputs.
std::string ToOnnx(const NetworkModel& model);

/// The warning about a weights file that does not name the trajectories it learned from.
std::string UnknownLearning(const std::filesystem::path& weights);

}  // namespace conav::nhpm
