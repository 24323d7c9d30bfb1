#pragma once

#include <map>

#include "common/protocol/supervision.h"
#include "operator/attention/attention_options.h"

namespace conav::operators {

/// How long this operator will need for a matter, learnt from how long such matters took.
///
/// Interaction times are taken to be log-normal, as service times of people are (for example Nehme,
/// "Modeling human supervisory control in heterogeneous unmanned vehicle systems", MIT 2009). The
/// prior of each reason counts as `weight` interactions at its median with its log-sd; the expected
/// time is that of the log-normal with the pooled mean m and variance v of the logarithms: exp(m +
/// v / 2). Seconds.
class InteractionTimes {
 public:
  explicit InteractionTimes(const InteractionPriors& priors) : priors_(priors) {}

  /// Below a millisecond, which nobody needs, a time counts as one millisecond.
  void Add(AttentionReason reason, double seconds);
  /// An interaction that was added turned out to be longer.
  void Replace(AttentionReason reason, double before_s, double now_s);
  double Expected(AttentionReason reason) const;

 private:
  struct Sums {
    double count = 0.0;
    double logs = 0.0;
    double squares = 0.0;
  };

  InteractionPriors priors_;
  std::map<AttentionReason, Sums> sums_;
};

}  // namespace conav::operators
