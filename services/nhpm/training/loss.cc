#include "nhpm/training/loss.h"

#include <cmath>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

/// exp(-a) for a >= 0: 2^-k exp(-r) with r in [-ln(2) / 2, ln(2) / 2], by its Taylor series.
double ExpMinus(double a) {
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // its last bits are 0: k kLn2High is exact
  constexpr double kLn2Low = 0x1.ef35793c76730p-45;
  if (a > 740.0) return 0.0;
  const double k = std::floor(a / (kLn2High + kLn2Low) + 0.5);
  const double r = (a - k * kLn2High) - k * kLn2Low;
  double sum = 1.0;
  for (int n = 14; n > 0; --n) sum = 1.0 - r / n * sum;
  return std::ldexp(sum, -static_cast<int>(k));
}

/// log(1 + t) for t in [0, 1]: 2 artanh(s), s = t / (2 + t) <= 1/3, by its series.
double LogOnePlus(double t) {
  const double s = t / (2.0 + t);
  double sum = 0.0;
  for (int n = 33; n > 0; n -= 2) sum = sum * (s * s) + 1.0 / n;
  return 2.0 * s * sum;
}

}  // namespace

double Softplus(double x) {
  if (std::isnan(x)) return x;
  return std::fmax(x, 0.0) + LogOnePlus(ExpMinus(std::fabs(x)));
}

double ExampleLoss(std::span<const float> logits, std::span<const OutputLabel> labels) {
  DEMAND(logits.size() == labels.size(), logits.size(), labels.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == OutputLabel::kMasked) continue;
    const double logit = static_cast<double>(logits[i]);
    sum += Softplus(labels[i] == OutputLabel::kEdited ? -logit : logit);
  }
  return sum / static_cast<double>(labels.size());
}

void LossGradient(std::span<const float> logits, std::span<const OutputLabel> labels, float factor,
                  std::span<float> gradient) {
  DEMAND(logits.size() == labels.size() && gradient.size() == labels.size(), logits.size(),
         labels.size(), gradient.size());
  const float scale = factor / static_cast<float>(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const float truth = labels[i] == OutputLabel::kEdited ? 1.0F : 0.0F;
    gradient[i] = labels[i] == OutputLabel::kMasked ? 0.0F : (Sigmoid(logits[i]) - truth) * scale;
  }
}

}  // namespace conav::nhpm
