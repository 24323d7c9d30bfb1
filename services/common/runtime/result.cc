#include "common/runtime/result.h"

#include <cstdio>
#include <cstdlib>

namespace conav {

void DemandFailed(const char* condition, const char* file, int line, const std::string& values) {
  fmt::print(stderr, "{}:{}: DEMAND({}) failed{}{}\n", file, line, condition,
             values.empty() ? "" : "; ", values);
  std::fflush(stderr);
  std::abort();
}

}  // namespace conav
