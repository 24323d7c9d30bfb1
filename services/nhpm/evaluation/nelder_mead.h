#pragma once

#include <functional>
#include <span>
#include <vector>

namespace conav::nhpm {

struct NelderMeadOptions {
  int iterations = 2000;    // at most
  double first_step = 0.5;  // of each coordinate
  /// Ends when the values at the corners differ by less than this, and each coordinate of the corners
  /// from the best one's by less than its square root: near a minimum values differ by the square.
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
/// local minimum; a value that is not a number counts as infinite. Deterministic.
/// Requires at least one coordinate.
NelderMeadResult MinimiseNelderMead(const std::function<double(std::span<const double>)>& function,
                                    std::span<const double> start,
                                    const NelderMeadOptions& options = {});

}  // namespace conav::nhpm
