#pragma once

#include <chrono>

namespace conav::operators {

/// Wall time as pages know it: s since 1970.
inline double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace conav::operators
