#include "nhpm/model/weights_message.h"

#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <cmath>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

/// Copies `values` where it has as many as `target` and they are finite.
Result<void> Fill(const google::protobuf::RepeatedField<float>& values, const std::string& what,
                  std::vector<float>& target) {
  if (static_cast<std::size_t>(values.size()) != target.size()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: {} values instead of {}", what, values.size(), target.size()));
  }
  for (int i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("{}: value {} is not finite ({})", what, i, values[i]));
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

}  // namespace

void AddLayers(const NetworkWeights& weights,
               google::protobuf::RepeatedPtrField<proto::Layer>& layers) {
  for (std::size_t i = 0; i < kNetworkLayers; ++i) {
    proto::Layer& layer = *layers.Add();
    layer.mutable_weights()->Assign(weights.weights[i].begin(), weights.weights[i].end());
    layer.mutable_biases()->Assign(weights.biases[i].begin(), weights.biases[i].end());
  }
}

Result<NetworkWeights> WeightsFrom(std::uint32_t width,
                                   const google::protobuf::RepeatedPtrField<proto::Layer>& layers) {
  if (width > 64 || !IsNetworkWidth(static_cast<int>(width))) {
    return Fail(ErrorCode::kMalformed, fmt::format("width {}, not 16, 32 or 64", width));
  }
  if (layers.size() != kNetworkLayers) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{} layers instead of {}", layers.size(), kNetworkLayers));
  }
  NetworkWeights result = ZeroWeights({static_cast<int>(width)});
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
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

}  // namespace conav::nhpm
