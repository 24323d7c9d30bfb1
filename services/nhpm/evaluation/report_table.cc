#include <fmt/format.h>

#include <algorithm>

#include "common/segments/segment_labels.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

std::string LossText(const std::optional<Loss>& loss) {
  return loss ? fmt::format("{:.5f}", loss->all) : "-";
}

std::string Counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string DescribePart(const SegmentSet& set) {
  std::size_t edits = 0;
  for (const Segment* segment : AllSegments(set)) {
    edits += static_cast<std::size_t>(EditCount(*segment));
  }
  return fmt::format("{}, {}, {}", Counted(set.trajectories.size(), "trajectory", "trajectories"),
                     Counted(SegmentCount(set), "segment", "segments"),
                     Counted(edits, "edit", "edits"));
}

std::string Line(const ModelRow& row, std::size_t width) {
  const ModelMetrics& test = row.test;
  return fmt::format(
      "{:<{}}{:>11}{:>11.5f}{:>10.5f}{:>9.3f} @ {:.2f}{:>10.3f}{:>9.5f}{:>10.3f}{:>7.3f}{:>8}\n",
      row.label.title, width, LossText(row.train), test.loss.all, test.loss.unmasked, test.best.iou,
      test.best.boundary, test.iou_fixed, test.calibration.error, test.edits.mean_expected,
      test.edits.mean_true,
      test.edits.correlation ? fmt::format("{:.2f}", *test.edits.correlation) : "-");
}

}  // namespace

std::string DescribeData(const EvaluationData& data) {
  std::string text = fmt::format("{} data, {}: test {}", OriginText(data.test), data.file,
                                 DescribePart(data.test));
  if (!data.split_seed) return text + "; the whole file is test";
  return text +
         fmt::format("; train {}; split seed {}", DescribePart(data.train), *data.split_seed);
}

std::string DescribeBar(const Bar& bar) {
  std::string text =
      fmt::format("{}  {}: {:.3f} (must be {} {:.3f}", bar.passed() ? "pass" : "FAIL", bar.text,
                  bar.value, bar.at_most ? "at most" : "more than", bar.limit);
  if (bar.interval) {
    text += fmt::format("; 90 % of test sets like this: {:.3f} to {:.3f}", bar.interval->low,
                        bar.interval->high);
  }
  return text + ")";
}

std::string ReportTable(const EvaluationReport& report) {
  std::size_t width = 14;
  for (const ModelRow& row : report.rows) width = std::max(width, row.label.title.size() + 2);
  std::string text = DescribeData(report.data) + "\n\n";
  text += fmt::format("{:<{}}{:>11}{:>11}{:>10}{:>16}{:>10}{:>9}{:>10}{:>7}{:>8}\n", "model", width,
                      "MBCE train", "MBCE test", "unmasked", "IoU @ best", "IoU @ 0.5", "ECE",
                      "expected", "edits", "correl.");
  for (const ModelRow& row : report.rows) text += Line(row, width);
  text += '\n';
  for (const ModelRow& row : report.rows) {
    text += fmt::format("{:<{}}{}\n", row.label.title, width, row.label.about);
  }
  if (!report.bars.empty()) text += '\n';
  for (const Bar& bar : report.bars) text += DescribeBar(bar) + "\n";
  return text;
}

}  // namespace conav::nhpm
