#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

namespace conav::statistics {

/// The fields of one line of comma-separated values (RFC 4180, without line breaks in a field),
/// without spaces around them. Errors: kMalformed for a quote that does not end, or not at a comma.
[[nodiscard]] Result<std::vector<std::string>> SplitCsvRow(std::string_view line);

}  // namespace conav::statistics
