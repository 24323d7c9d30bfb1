#include "common/segments/segment.h"

namespace conav {

int EditCount(const Segment& segment) {
  const auto before = segment.query.belief.values();
  const auto after = segment.belief_after.values();
  DEMAND(before.size() == after.size(), before.size(), after.size());
  int count = 0;
  for (std::size_t i = 0; i < before.size(); ++i) count += before[i] != after[i] ? 1 : 0;
  return count;
}

}  // namespace conav
