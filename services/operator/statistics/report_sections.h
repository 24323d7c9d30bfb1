#pragma once

#include <string>
#include <vector>

#include "operator/statistics/analysis.h"

namespace conav::statistics {

/// A table as it is shown, whatever by: the first column holds names, the others figures.
struct ReportSection {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> remarks;  // lines below
};

/// "ergoStool.csv: 9 subjects, 4 conditions".
std::string DescribeTable(const Analysis& analysis);

std::vector<ReportSection> ReportSections(const Analysis& analysis);

}  // namespace conav::statistics
