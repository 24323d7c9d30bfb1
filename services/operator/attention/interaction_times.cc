#include "operator/attention/interaction_times.h"

#include <algorithm>
#include <cmath>

namespace conav::operators {
namespace {

constexpr double kLeast = 1.0e-3;  // s

double LogOf(double seconds) { return std::log(std::max(seconds, kLeast)); }

}  // namespace

void InteractionTimes::Add(AttentionReason reason, double seconds) {
  Sums& sums = sums_[reason];
  const double log = LogOf(seconds);
  sums.count += 1.0;
  sums.logs += log;
  sums.squares += log * log;
}

void InteractionTimes::Replace(AttentionReason reason, double before_s, double now_s) {
  Sums& sums = sums_[reason];
  const double before = LogOf(before_s);
  sums.count -= 1.0;
  sums.logs -= before;
  sums.squares -= before * before;
  Add(reason, now_s);
}

double InteractionTimes::Expected(AttentionReason reason) const {
  const auto found = sums_.find(reason);
  const Sums heard = found == sums_.end() ? Sums{} : found->second;
  const double prior_log = LogOf(priors_.MedianOf(reason));
  const double count = priors_.weight + heard.count;
  const double mean = (priors_.weight * prior_log + heard.logs) / count;
  const double squares =
      priors_.weight * (priors_.log_sd * priors_.log_sd + prior_log * prior_log) + heard.squares;
  const double variance = std::max(0.0, squares / count - mean * mean);
  return std::exp(mean + variance / 2.0);
}

}  // namespace conav::operators
