#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace conav::statistics {

inline constexpr std::size_t kMostShapiroValues = 5000;  // what the algorithm was fitted for

/// Is this a sample of a normal distribution? W is near 1 if so.
struct ShapiroWilk {
  double w = 0.0;
  double p = 0.0;
};

/// Royston, "Remark AS R94: a remark on algorithm AS 181", Applied Statistics 44, 1995: the weights
/// of the ordered values and the normalising transformation of 1 - W are polynomials in the sample
/// size. Nothing for fewer than 3 values, for more than kMostShapiroValues, and for equal ones.
/// `error` is what rounding may do to a value.
std::optional<ShapiroWilk> TestNormality(std::span<const double> values, double error);

}  // namespace conav::statistics
