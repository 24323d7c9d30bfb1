#pragma once

#include <string>
#include <vector>

#include "nhpm/engine/network_weights.h"

namespace conav::bench {

/// What the figures were measured on.
std::string Machine();

/// 0 of no values.
double Median(std::vector<double> values);

/// The median of above[i] / below[i]: what was measured in one round saw the same machine.
double MedianRatio(const std::vector<double>& above, const std::vector<double>& below);

/// Of one forward pass over so many cells; a multiply-add counts as two.
double FlopsOfPass(const nhpm::NetworkShape& shape, int cells);

/// Processor time of the calling thread: what other programs do beside it does not count.
double ThreadSeconds();

}  // namespace conav::bench
