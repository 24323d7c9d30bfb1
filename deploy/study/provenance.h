#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "operator/statistics/report_sections.h"

namespace conav::study {

/// How a report came about, for whoever reads it later. Only the page has it: tables and JSON of
/// equal studies are equal.
struct Provenance {
  std::string command;  // as it was typed, after ./conav
  std::string commit;   // that ./conav built; "unknown" for a program run by hand
  std::string date;     // when the report was written, UTC
  std::string machine;  // processor and number of cores
};

/// Of this process. `argv` as main() has it.
Provenance DescribeRun(int argc, const char* const* argv);

/// The same, and the entries of the study's design that are short enough for a line.
statistics::ReportSection ProvenanceSection(const Provenance& provenance,
                                            const nlohmann::ordered_json& design);

}  // namespace conav::study
