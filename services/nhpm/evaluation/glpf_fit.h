#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/segments/segment.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

struct NelderMeadOptions {
  int iterations = 2000;    // at most
  double first_step = 0.5;  // of each coordinate
  /// Stops when the values at the corners differ by less than this, and each coordinate of the
  /// corners from the best one's by less than its square root: near a minimum values differ by the
  /// square.
  double tolerance = 1.0e-10;
};

struct NelderMeadResult {
  std::vector<double> position;
  double value = 0.0;
  int iterations = 0;
  bool converged = false;
};

/// Minimises `function` from `start` without derivatives, by the downhill simplex: reflection,
/// expansion, contraction, shrinking (J. A. Nelder, R. Mead, Computer Journal 7, 1965). Finds a
/// local minimum; NaN counts as infinite. Deterministic.
/// Requires at least one coordinate.
NelderMeadResult MinimiseNelderMead(const std::function<double(std::span<const double>)>& function,
                                    std::span<const double> start,
                                    const NelderMeadOptions& options = {});

/// Cells to which a GLPF always gives the same probability, whatever its parameters.
struct StimulusCount {
  double outputs = 0.0;
  double edits = 0.0;
};

/// The sufficient statistics of a GLPF's loss on a set of segments: how many cells have which
/// stimulus, and how many of them were edited. So a fit costs the same for any number of segments.
struct GlpfStatistics {
  /// By squared distance to the camera in cells: wrong on the map, according to the picture.
  std::map<int, StimulusCount> seen;
  /// Walls of the map on the path that the picture does not show: a stimulus unless visible_only.
  std::map<int, StimulusCount> on_path;
  StimulusCount unstimulated;

  double outputs() const;
};

/// Counts the unmasked outputs. The segments passed CheckSegment.
GlpfStatistics CountStimuli(std::span<const Segment* const> segments);

/// Mean cross-entropy of the GLPF over the unmasked outputs, in nats; 0 for none. Equals
/// MeanCrossEntropy(...).unmasked of its answers, except for their rounding to float.
double GlpfLoss(const GlpfStatistics& statistics, const GlpfParameters& parameters);

struct GlpfFitOptions {
  /// Empty = tries both and takes the better one.
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
  std::vector<GlpfVariant> variants;  // all variants tried
};

/// The GLPF's parameters of least cross-entropy: Nelder-Mead from a grid of starts, then once more
/// from the best. alpha_d and alpha_m in (0, 10], beta in (0, 1000], rho and lambda in [0, 0.5].
/// Deterministic; on equal losses the first variant wins.
/// Source: paper section 6.1 (GLPF-Train, GLPF-Test).
GlpfFit FitGlpf(const GlpfStatistics& statistics, const GlpfFitOptions& options = {});

}  // namespace conav::nhpm
