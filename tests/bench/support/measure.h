#pragma once

#include <string>
#include <vector>

namespace conav::bench {

/// What the figures were measured on.
std::string Machine();

/// 0 of no values.
double Median(std::vector<double> values);

/// Processor time of the calling thread: what other programs do beside it does not count.
double ThreadSeconds();

}  // namespace conav::bench
