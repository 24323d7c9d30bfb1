#pragma once

#include <string>

#include "common/runtime/result.h"
#include "nhpm/engine/network_weights.h"
#include "weights.pb.h"

namespace conav::nhpm {

/// Adds one message per layer.
void AddLayers(const NetworkWeights& weights,
               google::protobuf::RepeatedPtrField<proto::Layer>& layers);

/// The weights of a network of that width.
/// Errors: kMalformed: unknown width, wrong number of layers, weights or biases, a value that is
/// not finite; names the layer, the number and what it should be.
[[nodiscard]] Result<NetworkWeights> WeightsFrom(
    std::uint32_t width, const google::protobuf::RepeatedPtrField<proto::Layer>& layers);

/// The message as bytes that are equal for equal messages.
std::string BytesOf(const google::protobuf::Message& message);

}  // namespace conav::nhpm
