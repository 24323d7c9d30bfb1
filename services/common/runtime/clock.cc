#include "common/runtime/clock.h"

#include <cmath>

namespace conav {

SimTime SimTime::FromSeconds(double seconds) {
  return {static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}

}  // namespace conav
