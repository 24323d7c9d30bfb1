#include <algorithm>

#include "operator/statistics/report.h"
#include "operator/statistics/report_sections.h"

namespace conav::statistics {
namespace {

/// Characters, not bytes, of UTF-8.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned>(c) & 0xC0U) != 0x80U;
  }));
}

std::vector<std::size_t> Widths(const ReportSection& section) {
  std::vector<std::size_t> widths;
  for (const std::string& title : section.header) widths.push_back(Width(title));
  for (const auto& row : section.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
  }
  return widths;
}

/// Names to the left, figures to the right.
std::string Line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string line = "  " + cells[0] + std::string(widths[0] - Width(cells[0]), ' ');
  for (std::size_t c = 1; c < cells.size(); ++c) {
    line += std::string(2 + widths[c] - Width(cells[c]), ' ') + cells[c];
  }
  return line + "\n";
}

}  // namespace

std::string SectionText(const ReportSection& section) {
  const std::vector<std::size_t> widths = Widths(section);
  std::string text = "\n" + section.title + "\n" + Line(section.header, widths);
  for (const auto& row : section.rows) text += Line(row, widths);
  for (const std::string& remark : section.remarks) text += "  " + remark + "\n";
  return text;
}

std::string ReportText(const Analysis& analysis) {
  std::string text = DescribeTable(analysis) + "\n";
  for (const std::string& note : analysis.notes) text += "Note: " + note + "\n";
  for (const ReportSection& section : ReportSections(analysis)) text += SectionText(section);
  return text;
}

}  // namespace conav::statistics
