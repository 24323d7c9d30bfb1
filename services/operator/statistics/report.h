#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "operator/statistics/analysis.h"

namespace conav::statistics {

/// All tables for a terminal.
std::string ReportText(const Analysis& analysis);

/// Every figure at full precision, names as in docs/statistics.md. What is infinite or does not
/// exist is null; `notes` says why.
nlohmann::ordered_json ReportJson(const Analysis& analysis);

/// One page for a browser, without any other file: the same tables as the text, and a plot.
std::string ReportPage(const Analysis& analysis);

}  // namespace conav::statistics
