#include "common/protocol/planning.h"

namespace conav {

double ExpectedEdits(const PerceptionAnswer& answer) {
  double sum = 0.0;
  for (const float probability : answer.add.values()) sum += static_cast<double>(probability);
  for (const float probability : answer.remove.values()) sum += static_cast<double>(probability);
  return sum;
}

}  // namespace conav
