#pragma once

#include <unistd.h>

#include <fstream>

namespace conav::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMeasuresMemory = false;  // sanitizers keep what is freed
#else
constexpr bool kMeasuresMemory = true;
#endif

/// Resident memory of this process.
inline double ResidentMiB() {
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  double resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

}  // namespace conav::test
