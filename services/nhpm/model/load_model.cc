#include "nhpm/model/load_model.h"

#include <fmt/core.h>

#include "common/runtime/file.h"
#include "nhpm/model/encoder_decoder_model.h"
#include "nhpm/model/perception_network.h"
#include "nhpm/model/weights_file.h"

namespace conav::nhpm {

namespace {

Result<std::shared_ptr<PerceptionModel>> ModelOf(PerceptionModelKind kind,
                                                 const std::filesystem::path& file,
                                                 const NetworkModel& model) {
  const bool rasters = model.weights.shape.architecture == Architecture::kEncoderDecoder;
  const auto held = rasters ? PerceptionModelKind::kEncoderDecoder : PerceptionModelKind::kNhpm;
  if (kind != held) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: has weights of model {}, not of {}",
                                                         file.string(), Name(held), Name(kind)));
  }
  if (rasters) return std::make_shared<EncoderDecoderModel>(model);
  return std::make_shared<PerceptionNetwork>(model);
}

}  // namespace

std::filesystem::path ShippedWeights(PerceptionModelKind kind) {
  const bool rasters = kind == PerceptionModelKind::kEncoderDecoder;
  return ShippedFile(rasters ? "models/encoder-decoder.nhpm" : "models/default.nhpm");
}

std::filesystem::path WeightsOrShipped(const std::filesystem::path& weights,
                                       PerceptionModelKind kind) {
  return weights.empty() ? ShippedWeights(kind) : weights;
}

Result<std::shared_ptr<PerceptionModel>> LoadPerceptionModel(PerceptionModelKind kind,
                                                             const std::filesystem::path& weights,
                                                             const GlpfParameters& glpf) {
  if (kind == PerceptionModelKind::kGlpf) return std::make_shared<Glpf>(glpf);
  const std::filesystem::path file = WeightsOrShipped(weights, kind);
  return ReadWeightsFile(file).and_then(
      [&](const NetworkModel& model) { return ModelOf(kind, file, model); });
}

}  // namespace conav::nhpm
