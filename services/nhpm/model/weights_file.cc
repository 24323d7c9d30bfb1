#include "nhpm/model/weights_file.h"

#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kMagicSize = 4;
constexpr std::size_t kDigestSize = 64;
constexpr std::size_t kHeaderSize = kMagicSize + 4 + 8 + kDigestSize;

void AppendNumber(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
}

std::uint64_t NumberOf(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

template <class... Values>
tl::unexpected<Error> Malformed(fmt::format_string<Values...> text, Values&&... values) {
  return Fail(ErrorCode::kMalformed, fmt::format(text, std::forward<Values>(values)...));
}

/// Copies `values` to `target` after checking that the counts match and all values are finite.
Result<void> Fill(const google::protobuf::RepeatedField<float>& values, const std::string& what,
                  std::vector<float>& target) {
  if (static_cast<std::size_t>(values.size()) != target.size()) {
    return Malformed("{}: {} values instead of {}", what, values.size(), target.size());
  }
  for (int i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      return Malformed("{}: value {} is not finite ({})", what, i, values[i]);
    }
    target[static_cast<std::size_t>(i)] = values[i];
  }
  return {};
}

Result<void> FillLayer(const proto::Layer& message, int layer, NetworkWeights& result) {
  const auto i = static_cast<std::size_t>(layer);
  return Fill(message.weights(), fmt::format("weights of layer {}", layer), result.weights[i])
      .and_then([&] {
        return Fill(message.biases(), fmt::format("biases of layer {}", layer), result.biases[i]);
      });
}

static_assert(std::endian::native == std::endian::little, "checksums are over little-endian bytes");

constexpr FrameKind kWeightsFile{.magic = "CNVW", .version = 1, .name = "weights file"};
constexpr std::uint32_t kLargestWidth = 64;
constexpr std::uint32_t kMostCells = 4096;  // rows or columns

template <class T>
void Add(Sha256& digest, const std::vector<T>& values) {
  digest.Update(std::as_bytes(std::span(values)));
}

proto::Weights ToMessage(const NetworkModel& model) {
  proto::Weights message;
  message.set_name(model.name);
  message.set_version(model.version);
  message.set_width(static_cast<std::uint32_t>(model.weights.shape.width));
  message.set_architecture(ToMessage(model.weights.shape.architecture));
  AddLayers(model.weights, *message.mutable_layers());
  message.set_sees_belief(model.inputs.belief);
  message.set_sees_path(model.inputs.path);
  message.set_sees_view(model.inputs.view);
  message.set_masks_view(!model.inputs.depth);
  message.set_rows(static_cast<std::uint32_t>(model.rows));
  message.set_columns(static_cast<std::uint32_t>(model.columns));
  message.set_data_origin(model.data_origin);
  for (const auto& [name, text] : model.training) {
    proto::NamedText& entry = *message.add_training();
    entry.set_name(name);
    entry.set_text(text);
  }
  message.mutable_learned_from()->Assign(model.learned_from.begin(), model.learned_from.end());
  return message;
}

Result<void> CheckGridSize(const proto::Weights& message) {
  const bool any = message.rows() == 0 && message.columns() == 0;
  const bool one = message.rows() != 0 && message.columns() != 0 &&
                   message.architecture() != proto::ENCODER_DECODER;
  if ((any || one) && message.rows() <= kMostCells && message.columns() <= kMostCells) return {};
  return Malformed("impossible grid size {} x {}", message.rows(), message.columns());
}

NetworkModel ModelFrom(const proto::Weights& message, NetworkWeights weights) {
  NetworkModel model;
  model.name = message.name();
  model.version = message.version();
  model.weights = std::move(weights);
  model.inputs = {message.sees_belief(), message.sees_path(), message.sees_view(),
                  !message.masks_view()};
  model.rows = static_cast<int>(message.rows());
  model.columns = static_cast<int>(message.columns());
  model.data_origin = message.data_origin();
  for (const proto::NamedText& entry : message.training()) {
    model.training[entry.name()] = entry.text();
  }
  model.learned_from.assign(message.learned_from().begin(), message.learned_from().end());
  std::ranges::sort(model.learned_from);  // other programs may have written the file
  return model;
}

Result<NetworkModel> FromPayload(std::string_view payload) {
  proto::Weights message;
  if (!message.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return Malformed("its contents are not a Weights message");
  }
  if (const auto checked = CheckGridSize(message); !checked) {
    return tl::unexpected(checked.error());
  }
  return ArchitectureFrom(message.architecture())
      .and_then([&](Architecture architecture) {
        return WeightsFrom(message.width(), architecture, message.layers());
      })
      .map([&](NetworkWeights&& weights) { return ModelFrom(message, std::move(weights)); });
}

}  // namespace

std::string Frame(const FrameKind& kind, std::string_view payload) {
  DEMAND(kind.magic.size() == kMagicSize, kind.magic);
  std::string bytes(kind.magic);
  AppendNumber(bytes, kind.version, 4);
  AppendNumber(bytes, payload.size(), 8);
  bytes += Sha256Hex(payload);
  return bytes.append(payload);
}

Result<std::string_view> Unframe(const FrameKind& kind, std::string_view bytes) {
  if (bytes.empty()) return Malformed("empty, so no {}", kind.name);
  if (!bytes.starts_with(kind.magic)) return Malformed("no {}", kind.name);
  if (bytes.size() < kHeaderSize) {
    return Malformed("cut off after {} bytes of its header", bytes.size());
  }
  const std::uint64_t version = NumberOf(bytes.substr(4, 4));
  if (version != kind.version) {
    return Malformed("{} of format version {}; this program reads version {}", kind.name, version,
                     kind.version);
  }
  const std::uint64_t size = NumberOf(bytes.substr(8, 8));
  const std::string_view payload = bytes.substr(kHeaderSize);
  if (payload.size() != size) {
    return Malformed("{} bytes where its header says {}: {}", payload.size(), size,
                     payload.size() < size ? "cut off" : "extra bytes at the end");
  }
  if (Sha256Hex(payload) != bytes.substr(16, kDigestSize)) {
    return Malformed("damaged: its SHA-256 is not the one in its header");
  }
  return payload;
}

void AddLayers(const NetworkWeights& weights,
               google::protobuf::RepeatedPtrField<proto::Layer>& layers) {
  for (std::size_t i = 0; i < weights.weights.size(); ++i) {
    proto::Layer& layer = *layers.Add();
    layer.mutable_weights()->Assign(weights.weights[i].begin(), weights.weights[i].end());
    layer.mutable_biases()->Assign(weights.biases[i].begin(), weights.biases[i].end());
  }
}

proto::Architecture ToMessage(Architecture architecture) {
  return architecture == Architecture::kConvolutional ? proto::CONVOLUTIONAL
                                                      : proto::ENCODER_DECODER;
}

Result<Architecture> ArchitectureFrom(proto::Architecture message) {
  if (message == proto::CONVOLUTIONAL) return Architecture::kConvolutional;
  if (message == proto::ENCODER_DECODER) return Architecture::kEncoderDecoder;
  return Malformed("architecture {}, unknown to this program", static_cast<int>(message));
}

Result<NetworkWeights> WeightsFrom(std::uint32_t width, Architecture architecture,
                                   const google::protobuf::RepeatedPtrField<proto::Layer>& layers) {
  if (width > kLargestWidth || !IsNetworkWidth(static_cast<int>(width), architecture)) {
    return Malformed(
        "width {}, not {}", width,
        architecture == Architecture::kConvolutional ? "16, 32 or 64" : "4, 8, 16 or 32");
  }
  const NetworkShape shape{static_cast<int>(width), architecture};
  if (layers.size() != shape.layers()) {
    return Malformed("{} layers instead of {}", layers.size(), shape.layers());
  }
  NetworkWeights result = ZeroWeights(shape);
  for (int layer = 0; layer < shape.layers(); ++layer) {
    if (const auto filled = FillLayer(layers[layer], layer, result); !filled) {
      return tl::unexpected(filled.error());
    }
  }
  return result;
}

std::string BytesOf(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    const bool written = message.SerializeToCodedStream(&coded);
    DEMAND(written);
  }
  return bytes;
}

std::string ChecksumOf(const NetworkModel& model) {
  Sha256 digest;
  Add(digest, std::vector<std::uint32_t>{static_cast<std::uint32_t>(model.weights.shape.width),
                                         model.inputs.belief, model.inputs.path, model.inputs.view,
                                         static_cast<std::uint32_t>(model.rows),
                                         static_cast<std::uint32_t>(model.columns)});
  if (model.weights.shape.architecture == Architecture::kEncoderDecoder) {
    Add(digest, std::vector<std::uint32_t>{kEncoderDecoderLayers});
  }
  if (!model.inputs.depth) Add(digest, std::vector<std::uint32_t>{1});
  for (const auto& values : model.weights.weights) Add(digest, values);
  for (const auto& values : model.weights.biases) Add(digest, values);
  return digest.Hex();
}

Result<void> WriteWeightsFile(const std::filesystem::path& path, const NetworkModel& model) {
  return WriteFile(path, Frame(kWeightsFile, BytesOf(ToMessage(model))));
}

Result<NetworkModel> ReadWeightsFile(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return Unframe(kWeightsFile, *bytes).and_then(FromPayload).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", path.string(), error.text)};
  });
}

std::string UnknownLearning(const std::filesystem::path& weights) {
  return fmt::format(
      "{}: an old weights file that does not name its training trajectories; they may overlap with "
      "the test data",
      weights.string());
}

}  // namespace conav::nhpm
