#pragma once

#include <chrono>

namespace conav::operators {

/// Wall time as pages know it: s since 1970.
inline double ToWallSeconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
inline double WallSeconds() { return ToWallSeconds(std::chrono::system_clock::now()); }

}  // namespace conav::operators
