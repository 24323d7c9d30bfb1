#include "nhpm/model/encoder_decoder_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace conav::nhpm {
namespace {

constexpr std::size_t kIdlePasses = 4;

bool Fits(const EncoderDecoderPass& pass, const BeliefGrid& belief) {
  return pass.rows() == belief.rows() && pass.columns() == belief.columns();
}

}  // namespace

EncoderDecoderModel::EncoderDecoderModel(const NetworkModel& model)
    : identity_{model.name, model.version, ChecksumOf(model)},
      inputs_(model.inputs),
      weights_(std::make_shared<const NetworkWeights>(model.weights)) {
  DEMAND(model.weights.shape.architecture == Architecture::kEncoderDecoder, model.name);
}

EncoderDecoderModel::~EncoderDecoderModel() = default;

std::unique_ptr<EncoderDecoderPass> EncoderDecoderModel::TakePass(const BeliefGrid& belief) {
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(idle_, [&](const auto& pass) { return Fits(*pass, belief); });
    if (found != idle_.end()) {
      auto pass = std::move(*found);
      idle_.erase(found);
      return pass;
    }
  }
  auto pass = std::make_unique<EncoderDecoderPass>(weights_->shape, belief.rows(), belief.columns(),
                                                   EncoderDecoderPass::Use::kInference);
  pass->SetWeights(weights_);
  return pass;
}

void EncoderDecoderModel::KeepPass(std::unique_ptr<EncoderDecoderPass> pass) {
  const std::lock_guard lock(mutex_);
  if (idle_.size() == kIdlePasses) idle_.erase(idle_.begin());
  idle_.push_back(std::move(pass));
}

Result<std::vector<PerceptionAnswer>> EncoderDecoderModel::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  std::vector<float> input;
  std::unique_ptr<EncoderDecoderPass> pass;
  for (const PerceptionQuery& query : queries) {
    if (!pass || !Fits(*pass, query.belief)) {
      if (pass) KeepPass(std::move(pass));
      pass = TakePass(query.belief);
    }
    input.resize(query.belief.size() * kInputChannels);
    EncodeInput(query, inputs_, input, kRasterDepthRange);
    const std::span<const float> logits = pass->Forward(input);
    if (!std::ranges::all_of(logits, [](float logit) { return std::isfinite(logit); })) {
      return Fail(ErrorCode::kOutOfRange,
                  fmt::format("model {}: its weights are too large, an answer is not finite",
                              identity_.name));
    }
    answers.push_back(MaskedAnswer(query.belief, logits));
  }
  if (pass) KeepPass(std::move(pass));
  return answers;
}

}  // namespace conav::nhpm
