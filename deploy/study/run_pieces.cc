#include "study/run_pieces.h"

#include <fmt/format.h>

#include <cstdlib>

namespace conav::study {

Result<void> CheckDomains(int jobs) {
  if (jobs <= 1 || std::getenv("CONAV_DOMAIN") == nullptr) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--jobs {}: CONAV_DOMAIN leaves one DDS domain for all of them", jobs));
}

}  // namespace conav::study
