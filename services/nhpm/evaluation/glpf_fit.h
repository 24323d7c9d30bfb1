#pragma once

#include <optional>
#include <vector>

#include "nhpm/evaluation/glpf_statistics.h"

namespace conav::nhpm {

struct GlpfFitOptions {
  /// Nothing = both are tried and the better one is taken.
  std::optional<bool> visible_only;
  /// The paper prints one letter alpha for decay and midpoint. Two (false) include the case of one,
  /// so that the baseline is the strongest that the formula allows.
  std::optional<bool> tie_alphas = false;
};

/// One form of the GLPF, with its best parameters.
struct GlpfVariant {
  GlpfParameters parameters;
  double loss = 0.0;  // GlpfLoss
};

struct GlpfFit {
  GlpfVariant best;
  std::vector<GlpfVariant> variants;  // all that were tried
};

/// The GLPF's parameters of least cross-entropy: Nelder-Mead from a grid of starts, then once more
/// from the best. alpha_d and alpha_m in (0, 10], beta in (0, 1000], rho and lambda in [0, 0.5].
/// Deterministic; equal losses: the variant tried first.
/// Source: paper section 6.1 (GLPF-Train, GLPF-Test).
GlpfFit FitGlpf(const GlpfStatistics& statistics, const GlpfFitOptions& options = {});

}  // namespace conav::nhpm
