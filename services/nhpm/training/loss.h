#pragma once

#include <span>

#include "nhpm/training/example.h"

namespace conav::nhpm {

/// log(1 + exp(x)), within 1e-15 relatively, of plain double operations: the same bits on every
/// machine, so that early stopping keeps the same weights everywhere.
double Softplus(double x);

/// Mean binary cross-entropy (MBCE) of one example over ALL its outputs; masked ones cost 0:
///
///   sum over unmasked of (softplus(logit) - y logit)  /  (rows columns kOutputChannels)
///
/// Source: paper Appendix B (BCE, no class weight).
double ExampleLoss(std::span<const float> logits, std::span<const OutputLabel> labels);

/// d ExampleLoss / d logit, times `factor`: factor (sigmoid(logit) - y) / outputs, 0 where masked.
void LossGradient(std::span<const float> logits, std::span<const OutputLabel> labels, float factor,
                  std::span<float> gradient);

}  // namespace conav::nhpm
