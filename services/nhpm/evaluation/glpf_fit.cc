#include "nhpm/evaluation/glpf_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "nhpm/evaluation/nelder_mead.h"

namespace conav::nhpm {
namespace {

constexpr double kLargestAlpha = 10.0;
constexpr double kLargestBeta = 1000.0;
constexpr double kLargestRate = 0.5;

/// The search runs over all numbers: logarithms of the positive parameters, and angles for the
/// rates, which reach both ends of their range.
enum Coordinate : std::size_t { kAlphaD, kBeta, kRho, kLambda, kAlphaM, kCoordinates };

double FromLogarithm(double value, double largest) {
  return std::clamp(std::exp(value), 1.0e-9, largest);
}

double RateFromAngle(double angle) {
  const double sine = std::sin(angle);
  return kLargestRate * sine * sine;
}

double AngleFromRate(double rate) { return std::asin(std::sqrt(rate / kLargestRate)); }

GlpfParameters ParametersAt(std::span<const double> position, GlpfParameters form) {
  form.alpha_d = FromLogarithm(position[kAlphaD], kLargestAlpha);
  form.beta = FromLogarithm(position[kBeta], kLargestBeta);
  form.rho = RateFromAngle(position[kRho]);
  form.lambda = RateFromAngle(position[kLambda]);
  form.alpha_m = form.tie_alphas ? form.alpha_d : FromLogarithm(position[kAlphaM], kLargestAlpha);
  return form;
}

std::vector<double> PositionOf(const GlpfParameters& parameters) {
  std::vector<double> position(kCoordinates);
  position[kAlphaD] = std::log(parameters.alpha_d);
  position[kBeta] = std::log(parameters.beta);
  position[kRho] = AngleFromRate(parameters.rho);
  position[kLambda] = AngleFromRate(parameters.lambda);
  position[kAlphaM] = std::log(parameters.alpha_m);
  if (parameters.tie_alphas) position.pop_back();
  return position;
}

std::vector<GlpfParameters> Starts(const GlpfParameters& form) {
  std::vector<GlpfParameters> starts;
  for (const double alpha_d : {0.03, 0.1, 0.3, 1.0}) {
    for (const double alpha_m : {0.2, 0.7}) {
      for (const double beta : {4.0, 20.0}) {
        GlpfParameters start = form;
        start.alpha_d = alpha_d;
        start.alpha_m = form.tie_alphas ? alpha_d : alpha_m;
        start.beta = beta;
        start.rho = 0.003;
        start.lambda = 0.1;
        starts.push_back(start);
      }
    }
  }
  return starts;
}

GlpfVariant FitForm(const GlpfStatistics& statistics, const GlpfParameters& form) {
  const auto loss = [&](std::span<const double> position) {
    return GlpfLoss(statistics, ParametersAt(position, form));
  };
  GlpfVariant best{form, std::numeric_limits<double>::infinity()};
  const auto improve_from = [&](const GlpfParameters& start) {
    const NelderMeadResult found =
        MinimiseNelderMead(loss, PositionOf(start), {.tolerance = 1.0e-13});
    if (found.value < best.loss) best = {ParametersAt(found.position, form), found.value};
  };
  for (const GlpfParameters& start : Starts(form)) improve_from(start);
  improve_from(best.parameters);  // a fresh simplex gets out of where the first one collapsed
  return best;
}

std::vector<bool> Choices(std::optional<bool> wanted) {
  if (wanted) return {*wanted};
  return {false, true};
}

}  // namespace

GlpfFit FitGlpf(const GlpfStatistics& statistics, const GlpfFitOptions& options) {
  GlpfFit fit;
  for (const bool tie_alphas : Choices(options.tie_alphas)) {
    for (const bool visible_only : Choices(options.visible_only)) {
      GlpfParameters form;
      form.tie_alphas = tie_alphas;
      form.visible_only = visible_only;
      fit.variants.push_back(FitForm(statistics, form));
    }
  }
  fit.best =
      *std::min_element(fit.variants.begin(), fit.variants.end(),
                        [](const GlpfVariant& a, const GlpfVariant& b) { return a.loss < b.loss; });
  return fit;
}

}  // namespace conav::nhpm
