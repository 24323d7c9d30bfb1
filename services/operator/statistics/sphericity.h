#pragma once

#include <optional>

#include "operator/statistics/condition_table.h"

namespace conav::statistics {

/// Whether all differences between conditions vary alike, which the uncorrected F test takes for
/// granted, and by how much its degrees of freedom must shrink where they do not. All of it follows
/// from the covariance S (p x p, p = k - 1) of orthonormal contrasts of the k conditions.
struct Sphericity {
  /// Mauchly, 1940: W = det S / (tr S / p)^p, 0 where S is singular. p is that of
  /// chi squared with the second-order term of Box's series, as in R. Nothing for two conditions,
  /// where there is nothing to test, and for fewer subjects than conditions.
  std::optional<double> mauchly_w;
  std::optional<double> mauchly_p;
  /// Greenhouse and Geisser, 1959: (tr S)^2 / (p tr S^2), in [1 / p, 1].
  double greenhouse_geisser = 1.0;
  /// Huynh and Feldt, 1976, as first printed; may be above 1 (infinite with too few subjects).
  /// Nothing for two subjects and more than two conditions: 0 / 0.
  std::optional<double> huynh_feldt_raw = 1.0;
  /// What degrees of freedom are multiplied by: min(1, raw).
  std::optional<double> huynh_feldt = 1.0;
};

/// Nothing where the conditions differ by the same amounts for every subject: S is zero.
std::optional<Sphericity> CheckSphericity(const ConditionTable& table);

}  // namespace conav::statistics
